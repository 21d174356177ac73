#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/machines/unit_kinds.h"
#include "hw_models/srp/schedule.h"
#include "shader_kernels/catalogue.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/host/standard_streams.h"
#include "tools/intervals/run_intervals.h"
#include "tools/pricing/priced_run.h"
#include "tools/studies/report/page_data.h"
#include "tools/studies/report/pictures.h"

namespace tools::pages {
namespace {

using sim::Json;

constexpr std::size_t kLongestText = 2000, kLongestCommand = 4000;
constexpr std::size_t kMostIntervals = 512;
/// Events below this share of the total, at its low, nominal and high, are joined within their block.
constexpr double kSmallShare = 0.008;
constexpr const char* kTotal = "GPU with memory";

std::string command_of(const ReportFile& report) {
  const sim::JsonPointer argv("/provenance/argv");
  if (!report.json.contains(argv)) return {};
  std::vector<std::string> words;
  for (const Json& word : report.json.at(argv)) {
    if (word.is_string()) words.push_back(word.get<std::string>());
  }
  return sim::printable(command_text(words), kLongestCommand);
}

/// Returns the report without most of what its frames contain.
Json trimmed_report(Json report) {
  const auto frames = report.find("frames");
  if (frames == report.end() || !frames->is_array()) return report;
  for (Json& frame : *frames) {
    Json kept = Json::object();
    for (const char* key : {"frame", "time_ms", "energy_mj", "rays", "limiter"}) {
      if (frame.is_object() && frame.contains(key)) kept[key] = frame[key];
    }
    frame = std::move(kept);
  }
  return report;
}

Json unit_kinds_json() {
  Json out = Json::array();
  for (const hw::UnitKind& unit : hw::kUnitKinds) {
    Json reasons = Json::array();
    for (const sim::Reason& reason : unit.reasons)
      reasons.push_back(
          {{"name", reason.name}, {"kind", static_cast<std::uint32_t>(reason.kind)}, {"meaning", reason.meaning}});
    out.push_back({{"name", unit.name}, {"reasons", std::move(reasons)}});
  }
  return out;
}

/// Returns what limits the initiation interval of a kernel.
std::string bound_of(const hw::KernelSchedule& s, const hw::ArrayConfig& array) {
  using hw::OpClass;
  if (s.rec_mii >= s.ii) return "values from item to item";
  const auto ops = [&](OpClass op) { return static_cast<double>(s.ops[static_cast<std::size_t>(op)]); };
  const auto per_unit = [](double work, std::uint32_t units) { return units == 0 ? 0 : work / units; };
  // The least interval at which the operations fit each resource.
  const std::pair<double, const char*> most = std::max<std::pair<double, const char*>>(
      {{per_unit(s.fu_ops, array.unit_count()), "functional units"},
       {per_unit(ops(OpClass::kFpMul) + ops(OpClass::kFpMulAdd) + ops(OpClass::kIntMul), array.mul_units),
        "multipliers"},
       {per_unit(ops(OpClass::kFpDivSqrt), array.div_sqrt_units), "dividers"},
       {per_unit(s.local_reads + s.local_writes, array.local_ports), "local-memory ports"},
       {per_unit(s.queued_loads, array.cache_ports), "data-cache ports"}},
      [](const auto& a, const auto& b) { return a.first < b.first; });
  if (s.ii > s.res_mii) return fmt::format("the schedule: {} alone allow {}", most.second, s.res_mii);
  return most.second;
}

Json kernels_json(const ReportFile& report, const PricedRun* priced) {
  Json out = Json::object();
  const sim::JsonPointer kernels("/totals/kernels");
  if (!report.json.contains(kernels) || !report.json.at(kernels).is_object()) return out;
  for (const auto& [name, kernel] : report.json.at(kernels).items()) {
    const kernels::KernelInfo* const info = kernels::find_kernel(name);
    if (info == nullptr) continue;
    out[name]["meaning"] = info->meaning;
    if (priced == nullptr) continue;
    const hw::SrpConfig& srp = priced->config().gpu->srp;
    const hw::KernelSchedule schedule = hw::schedule_kernel(info->graph, srp);
    if (schedule.ii == report.number(fmt::format("totals.kernels.{}.ii", name)))
      out[name]["bound"] = bound_of(schedule, srp.array);
  }
  return out;
}

bool is_small(const sim::Band& pj, const sim::Band& total) {
  return pj.low < kSmallShare * total.low && pj.nominal < kSmallShare * total.nominal &&
         pj.high < kSmallShare * total.high;
}

/// Returns links from the total to blocks, and from each block to its events, its clock and its leakage. Standby of the
/// memory is moved from leakage to an event.
Json energy_flow(const PricedRun& run) {
  const sim::EnergyReport energy = run.energy();
  const auto device = hw::dram_energy_events(run.config().gpu->dram);
  std::map<std::pair<std::string, std::string>, sim::Band> links;
  const auto add = [&](const std::string& from, const std::string& to, const sim::Band& pj) {
    if (pj.high > 0) links[{from, to}] += pj;
  };
  for (const auto& [block, kinds] : energy.blocks) {
    add(kTotal, block, kinds.total());
    add(block, "clock", kinds.clock);
    sim::Band leakage = kinds.leakage;
    if (const auto events = energy.events.find(block); events != energy.events.end()) {
      for (const auto& [name, pj] : events->second) {
        const auto of_device = device.find(name);
        if (of_device != device.end() && of_device->second.standby) leakage += pj * -1.0;
        const bool is_prefixed = name.starts_with(block + ".");
        const std::string words = is_prefixed ? name.substr(block.size() + 1) : name;
        add(block, fmt::format("{}: {}", block, is_small(pj, energy.total_pj) ? "other events" : words), pj);
      }
    }
    add(block, "leakage", leakage);
  }
  Json out = Json::array();
  for (const auto& [ends, pj] : links) {
    out.push_back(Json::array({ends.first, ends.second, pj.low / sim::kPicojoulesPerMillijoule,
                               pj.nominal / sim::kPicojoulesPerMillijoule, pj.high / sim::kPicojoulesPerMillijoule}));
  }
  return out;
}

/// Returns the series of the first frame over time, without those that are always 0.
Json series_json(const ReportFile& report) {
  if (!RunIntervals::are_beside(report)) return {{"note", "This run has no intervals of time."}};
  try {
    const RunIntervals intervals(report);
    if (intervals.frames().empty()) throw sim::InputError("its file of intervals is empty");
    const IntervalTable table =
        derive_table(intervals, intervals.frames().front(), &sim::Band::nominal, kMostIntervals);
    Json all = Json::array();
    for (const IntervalSeries& series : table.series) {
      const auto is_nothing = [](double value) { return value == 0 || !std::isfinite(value); };
      if (std::ranges::all_of(series.values, is_nothing)) continue;
      all.push_back({{"group", series.group},
                     {"name", series.name},
                     {"unit", series.unit},
                     {"values", page_numbers(series.values)}});
    }
    if (all.empty()) throw sim::InputError("nothing happened in any interval");
    return {{"note", intervals.frames().size() > 1 ? "Of the first frame." : ""},
            {"begin_us", page_numbers(table.begin_us)},
            {"end_us", page_numbers(table.end_us)},
            {"all", std::move(all)}};
  } catch (const sim::InputError& error) {
    print_message("warning: {}; the page shows no metrics over time", error.what());
    return {{"note", fmt::format("Metrics over time are not shown: {}", error.what())}};
  }
}

}  // namespace

std::string run_title(const ReportFile& report) {
  const auto program = report.json.find("program");
  const bool has_program = program != report.json.end() && program->is_string();
  return fmt::format("{}, {}x{}, {}", sim::printable(report.text("scene", "name"), kLongestText),
                     report.number("resolution[0]"), report.number("resolution[1]"),
                     has_program ? sim::printable(program->get_ref<const std::string&>(), kLongestText) : "");
}

Json run_data(const ReportFile& report) {
  std::unique_ptr<PricedRun> priced;
  std::string not_priced;
  try {
    priced = std::make_unique<PricedRun>(report);
  } catch (const sim::InputError& error) {
    not_priced = error.what();
  }
  Json resources = Json::object();
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources)
    resources[resource.name] = resource.words;
  return {{"title", run_title(report)},
          {"command", command_of(report)},
          {"report", trimmed_report(report.json)},
          {"unit_kinds", unit_kinds_json()},
          {"resources", std::move(resources)},
          {"kernels", kernels_json(report, priced.get())},
          {"flow", priced ? energy_flow(*priced) : Json()},
          {"not_priced", not_priced},
          {"series", series_json(report)},
          {"picture", run_picture(report)}};
}

}  // namespace tools::pages
