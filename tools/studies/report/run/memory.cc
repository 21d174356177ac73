#include <fmt/format.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "sim/report/table.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

/// A level of the memory hierarchy and its counters.
struct Cache {
  const char* words;
  std::string unit;
  const char *accesses, *hits, *fills, *miss_cycles, *missed;
  const char* size;  ///< key of its size
};

std::vector<Cache> caches() {
  return {{"node L1", std::string(hw::Trv::kName), "l1_accesses", "l1_hits", "l1_fills", "l1_miss_cycles", "l1_fills",
           "config.tni.trv.l1.size"},
          {"triangle L1", std::string(hw::Ist::kName), "l1_accesses", "l1_hits", "l1_fills", "l1_miss_cycles",
           "l1_fills", "config.tni.ist.l1.size"},
          {"data cache", std::string(hw::Srp::kName), "cache_accesses", "cache_hits", "cache_fills",
           "cache_miss_cycles", "cache_fills", "config.srp.cache.size"},
          {"L2", std::string(hw::L2Bank::kName), "reads", "hits", "fills", "line_cycles", "fills", "config.l2.size"}};
}

void add_caches(const Run& run, View& view) {
  Dataset data({{"cache", "cache"},
                {"rate", "hit rate", Show::kPercent},
                {"label", "shown"},
                {"accesses", "accesses", Show::kSi},
                {"fills", "lines filled", Show::kSi},
                {"miss", "cycles from miss to line", Show::kNumber},
                {"units", "of them", Show::kNumber}});
  for (const Cache& cache : caches()) {
    const std::string path = fmt::format("units.{}.", cache.unit);
    const auto counted = [&](const char* name) { return run.report.number(path + "counters." + name); };
    const double accesses = counted(cache.accesses);
    if (accesses == 0) continue;
    const double rate = counted(cache.hits) / accesses, missed = counted(cache.missed);
    data.row({cache.words, rate, percent_text(rate), accesses, counted(cache.fills),
              missed > 0 ? Json(counted(cache.miss_cycles) / missed) : Json(), run.report.number(path + "units")});
  }
  view.data("caches", data);
}

void add_traffic(const Run& run, View& view) {
  Dataset clients(
      {{"client", "who"}, {"bytes", "bytes", Show::kSi, "B"}, {"share", "share", Show::kPercent}, {"label", "shown"}});
  const double all = run.number("totals.dram_bytes");
  if (const Json& by = at(run.totals(), {"dram_bytes_by_client"}); by.is_object()) {
    for (const auto& [name, bytes] : by.items()) {
      if (!bytes.is_number() || all <= 0) continue;
      std::string words = name;
      std::ranges::replace(words, '_', ' ');
      const double count = bytes.get<double>();
      clients.row(
          {words, count, count / all, fmt::format("{}, {}", sim::si_text(count, "B"), percent_text(count / all))});
    }
  }
  view.data("traffic", clients);
}

void add_dram(const Run& run, View& view) {
  const std::string path = fmt::format("units.{}.", hw::DramChannel::kName);
  const auto counted = [&](const char* name) { return run.report.number(path + "counters." + name); };
  const double lines = counted("reads") + counted("writes"), elapsed = run.report.number(path + "elapsed");
  Dataset data({{"what", "memory channels"}, {"value", "value"}});
  if (lines > 0 && elapsed > 0) {
    const double bus = (run.report.number(path + "why.reading") + run.report.number(path + "why.writing")) / elapsed;
    const double rate = run.seconds() > 0 ? run.number("totals.dram_bytes") / run.seconds() : 0;
    data.row({"bandwidth used", fmt::format("{} of {} ({})", sim::si_text(rate, "B/s"), sim::si_text(rate / bus, "B/s"),
                                            percent_text(bus))});
    data.row({"lines whose row was open", percent_text(counted("row_hits") / lines)});
    data.row({"lines for which another row was closed", percent_text(counted("row_conflicts") / lines)});
    data.row({"mean read latency", fmt::format("{:.1f} command clocks", counted("read_latency") / counted("reads"))});
    data.row({"longest read latency of a channel", fmt::format("{:.0f} command clocks", [&] {
                double most = 0;
                for (int channel = 0; channel < 64; ++channel) {
                  most = std::max(
                      most, run.report.number(fmt::format("units.dram.channel{}.counters.read_latency_max", channel)));
                }
                return most;
              }())});
    data.row({"cycles in refresh", percent_text(run.report.number(path + "why.refresh") / elapsed)});
  }
  view.data("dram", data);
}

}  // namespace

void add_memory(const Run& run, View& view) {
  Section section("memory", "Caches and memory");
  add_caches(run, view);
  add_traffic(run, view);
  add_dram(run, view);
  section.chart("hit-rates", "Hit rates", "Hit rate of each kind of cache", "caches",
                {{"kind", "bars"},
                 {"name", "cache"},
                 {"value", "rate"},
                 {"title", "of its accesses, retries included"},
                 {"format", ".0%"},
                 {"label", "label"}});
  section.table("cache-table", "Caches, all units of a kind", "caches");
  section.chart("traffic", "DRAM traffic by who asked", "Bytes over the memory channels, by who asked for them",
                "traffic",
                {{"kind", "bars"},
                 {"name", "client"},
                 {"value", "bytes"},
                 {"title", "bytes"},
                 {"format", "~s"},
                 {"label", "label"}});
  section.table("dram-table", "Memory channels", "dram");
  view.add(section);
}

}  // namespace tools::pages
