#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/dram/dram_measurements.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/microbench/dram_stream.h"
#include "tools/studies/microbench/figure.h"

namespace tools {
namespace {

using sim::Json;

double ns_of(sim::Time time) { return static_cast<double>(time) / sim::kFemtosecondsPerNs; }

/// Latencies of some of the requests, in ns.
struct Latencies {
  static constexpr std::array<const char*, 6> kNames = {"min", "p50", "p90", "p99", "max", "mean"};
  std::array<double, 6> values{};
  std::size_t count = 0;

  explicit Latencies(std::vector<double> all) : count(all.size()) {
    if (all.empty()) return;
    double sum = 0;
    for (const double ns : all) sum += ns;
    const auto rank = [&](double part) {  // nearest rank
      const auto nth = all.begin() + static_cast<std::ptrdiff_t>(std::ceil(part * static_cast<double>(count))) - 1;
      std::ranges::nth_element(all, nth);
      return *nth;
    };
    const auto [min, max] = std::ranges::minmax(all);
    values = {min, rank(0.5), rank(0.9), rank(0.99), max, sum / static_cast<double>(count)};
  }
  Json json() const {
    Json j = Json::object();
    for (std::size_t i = 0; i < kNames.size(); ++i) j[kNames[i]] = values[i];
    return j;
  }
};

/// A stream that was played, and what follows from it.
struct Result {
  const hw::DramConfig& config;
  const hw::DramPlay play;
  const std::uint32_t outstanding;
  Latencies all, reads, writes;

  Result(const hw::DramConfig& c, const std::vector<hw::DramRequest>& requests, std::uint32_t limit)
      : config(c),
        play(hw::play(c, requests, limit)),
        outstanding(limit),
        all(latencies(requests, true, true)),
        reads(latencies(requests, true, false)),
        writes(latencies(requests, false, true)) {}

  double gbps() const { return static_cast<double>(play.stats.bytes) / ns_of(play.end); }
  double peak_gbps() const {
    return static_cast<double>(config.organisation.burst.bytes) / ns_of(config.timing.burst * config.timing.ck.time);
  }
  double hit_rate() const { return static_cast<double>(play.stats.row_hits) / static_cast<double>(all.count); }
  sim::Band pj_per_bit() const {
    return hw::dram_energy(config, play.stats) * (1 / (8 * static_cast<double>(play.stats.bytes)));
  }

 private:
  std::vector<double> latencies(const std::vector<hw::DramRequest>& requests, bool of_reads, bool of_writes) const {
    std::vector<double> ns;
    for (std::size_t i = 0; i < requests.size(); ++i) {
      if (requests[i].write ? of_writes : of_reads) ns.push_back(ns_of(play.latency(i)));
    }
    return ns;
  }
};

Json stream_json(const Result& r) {
  const hw::DramChannel::Stats& s = r.play.stats;
  Json why = Json::object(), counters = Json::object(), done = Json::array();
  for (const auto& [reason, cycles] : r.play.why) why[reason] = cycles;
  hw::DramChannel::Stats::describe(
      s, [&](std::uint64_t value, const char* name, const char*, auto&&...) { counters[name] = value; });
  for (const sim::Time time : r.play.done) done.push_back(ns_of(time));
  return {{"schema", "raywatt-microbench-dram/1"},
          {"grade", r.config.grade},
          {"outstanding", r.outstanding},
          {"requests", r.all.count},
          {"reads", s.reads},
          {"writes", s.writes},
          {"time_ns", ns_of(r.play.end)},
          {"bandwidth_gbps", r.gbps()},
          {"peak_gbps", r.peak_gbps()},
          {"bandwidth_of_peak", r.gbps() / r.peak_gbps()},
          {"row_hits", s.row_hits},
          {"row_misses", s.row_misses},
          {"row_conflicts", s.row_conflicts},
          {"row_hit_rate", r.hit_rate()},
          {"latency_ns", r.all.json()},
          {"read_latency_ns", r.reads.json()},
          {"write_latency_ns", r.writes.json()},
          {"energy_pj_per_bit", sim::band_json(r.pj_per_bit())},
          {"why", std::move(why)},
          {"counters", std::move(counters)},
          {"completion_ns", std::move(done)}};
}

std::string stream_text(const Result& r) {
  std::string all;
  const hw::DramChannel::Stats& s = r.play.stats;
  const auto line = [&](const char* name, const std::string& text) { all += fmt::format("{:<14}{}\n", name, text); };
  line("memory", fmt::format("one channel of {}, lines of {} B, up to {} outstanding", r.config.grade,
                             r.config.line.bytes, r.outstanding));
  line("requests", fmt::format("{} ({} reads, {} writes)", r.all.count, s.reads, s.writes));
  line("time", fmt::format("{:.3f} us", ns_of(r.play.end) / 1000));
  line("bandwidth",
       fmt::format("{:.3f} GB/s ({:.1f} % of {:.2f} GB/s)", r.gbps(), 100 * r.gbps() / r.peak_gbps(), r.peak_gbps()));
  line("rows", fmt::format("{} hits ({:.1f} %), {} misses, {} conflicts", s.row_hits, 100 * r.hit_rate(), s.row_misses,
                           s.row_conflicts));
  const sim::Band energy = r.pj_per_bit();
  line("energy", fmt::format("{:.2f} pJ/bit (low {:.2f}, high {:.2f})", energy.nominal, energy.low, energy.high));
  const double cycles = static_cast<double>(r.config.timing.ck.time) / static_cast<double>(r.play.end);
  std::string went;
  for (const auto& [reason, spent] : r.play.why) {
    if (spent != 0)
      went += fmt::format("{}{} {:.1f} %", went.empty() ? "" : ", ", reason, 100 * cycles * static_cast<double>(spent));
  }
  line("time went to", went);

  sim::Table table({"latency, ns", "min", "p50", "p90", "p99", "max", "mean"});
  const auto row = [&](const char* name, const Latencies& of) {
    if (of.count == 0) return;
    std::vector<std::string> cells = {name};
    for (const double ns : of.values) cells.push_back(fmt::format("{:.1f}", ns));
    table.add_row(std::move(cells));
  };
  row("all", r.all);
  row("reads", r.reads);
  row("writes", r.writes);
  return all + "\n" + table.text();
}

Figure::Holds same(hw::DramMeasurement::Holds holds) {
  using Holds = hw::DramMeasurement::Holds;
  switch (holds) {
    case Holds::kExactly:
      return Figure::Holds::kExactly;
    case Holds::kClosely:
      return Figure::Holds::kClosely;
    case Holds::kNearly:
      return Figure::Holds::kNearly;
    case Holds::kAtMost:
      break;
  }
  return Figure::Holds::kAtMost;
}

hw::DramConfig memory_of(const BenchmarkJob& job, const JobOptions& machine) {
  hw::DramConfig config = load_run_config(machine).gpu->dram;
  if (job.refresh == "off") config.timing.refi_pb = config.timing.refi_ab = 0;
  return config;
}

void add(Findings& findings, const std::string& prefix, const std::vector<hw::DramMeasurement>& measured) {
  for (const hw::DramMeasurement& f : measured)
    findings.figures.push_back({prefix + f.name, f.unit, f.measured, f.expected, same(f.holds)});
}

/// Energy of every grade in configs/dram, a channel each.
Findings energies_of_grades(const BenchmarkJob& job) {
  Findings findings{"energy of a channel of each grade", {}};
  for (const JobOptions& of_grade : jobs_of_all_grades(job.machine)) {
    const hw::DramConfig config = memory_of(job, of_grade);
    add(findings, config.grade + ", ", hw::dram_energy_measurements(config));
  }
  return findings;
}

Findings measure(const BenchmarkJob& job) {
  if (job.all_grades && !job.stream.empty()) {
    throw sim::InputError("--all-grades does not go with --stream; allowed: one of them");
  }
  if (job.all_grades) return energies_of_grades(job);
  const hw::DramConfig config = memory_of(job, job.machine);
  if (job.stream.empty()) {
    Findings findings{config.grade + ", a channel", {}};
    add(findings, "", hw::dram_measurements(config));
    return findings;
  }
  const std::vector<hw::DramRequest> requests = load_dram_stream(job.stream);
  const Result result(config, requests, job.outstanding == 0 ? config.controller.read_queue : job.outstanding);
  return {.title = {}, .figures = {}, .printed = job.json ? sim::json_text(stream_json(result)) : stream_text(result)};
}

}  // namespace

Benchmark dram_benchmark() {
  return {
      "dram",
      "A memory channel alone: what its grade allows, or a file of requests",
      "All requests go to one channel, in the order of the file. Addresses are the channel's own: bits that would\n"
      "choose among channels are not there, bits beyond its capacity do not count. A request for any byte is one for\n"
      "its line (dram.line). Read or written, it is done when the last of its data has passed the bus; dram.fabric is\n"
      "left out. Time 0 is when the first request may reach the channel. Percentiles are by nearest rank.\n"
      "\n"
      "Example: raywatt microbench dram --stream requests.txt --outstanding 16 --refresh off\n"
      "Example: raywatt microbench dram --set dram.extends=dram/lpddr5-6400\n"
      "Example: raywatt microbench dram --all-grades",
      {{"--stream",
        "play this file, or standard input if it is -. A line is a hexadecimal address, R or W, and if\n"
        "wanted the earliest time in ns. Without it: a table of figures beside their closed forms",
        &BenchmarkJob::stream},
       {"--outstanding",
        "requests sent and not done, at most; a write is done when the channel has taken it\n(default: "
        "dram.controller.read_queue)",
        &BenchmarkJob::outstanding,
        false,
        {},
        65536},
       {"--all-grades", "energy of each speed grade in configs/dram in turn", &BenchmarkJob::all_grades},
       {"--refresh", "off: no refreshes", &BenchmarkJob::refresh, true, {"on", "off"}},
       {"--json", "as JSON, with every request's completion time", &BenchmarkJob::json}},
      measure};
}

}  // namespace tools
