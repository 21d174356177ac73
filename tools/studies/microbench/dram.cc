#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/dram/dram_measurements.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/microbench/benchmark.h"

namespace tools {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr double kLatestNs = 1e9;

std::string read_standard_input() {
  std::string text;
  std::array<char, 65536> part;
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), stdin)) {
    text.append(part.data(), n);
    if (text.size() > kMostBytes) throw sim::InputError("standard input: more than 1 GiB of requests");
  }
  if (std::ferror(stdin) != 0) throw sim::IoError("standard input: reading failed");
  return text;
}

class StreamParser {
 public:
  StreamParser(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {}

  std::vector<hw::DramRequest> parse_all() {
    std::vector<hw::DramRequest> requests;
    while (!rest_.empty()) {
      number_ += 1;
      const std::size_t end = rest_.find('\n');
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      line_ = line_.substr(0, line_.find('#'));
      if (const std::string_view first = next_word(); !first.empty()) requests.push_back(parse_request(first));
    }
    if (requests.empty()) throw sim::InputError(fmt::format("{}: no requests; {}", name_, kAllowed));
    return requests;
  }

 private:
  static constexpr std::string_view kAllowed =
      "a line is a hexadecimal address, R or W, and optionally an earliest time in ns, such as '0x1f40 R 12.5'";

  std::string_view next_word() {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    std::size_t begin = 0;
    while (begin < line_.size() && is_blank(line_[begin])) ++begin;
    std::size_t end = begin;
    while (end < line_.size() && !is_blank(line_[end])) ++end;
    const std::string_view word = line_.substr(begin, end - begin);
    line_.remove_prefix(end);
    return word;
  }

  hw::DramRequest parse_request(std::string_view address) {
    hw::DramRequest r;
    const std::string_view kind = next_word(), time = next_word(), more = next_word();
    const bool prefixed = address.starts_with("0x") || address.starts_with("0X");
    const std::string_view digits = address.substr(prefixed ? 2 : 0);
    const auto [rest, bad] = std::from_chars(digits.data(), digits.data() + digits.size(), r.address, 16);
    if (bad != std::errc{} || rest != digits.data() + digits.size())
      refuse(address, "is not a hexadecimal address of at most 64 bits");
    if (kind.empty()) refuse(address, "is followed by neither R nor W");
    if (kind != "R" && kind != "W") refuse(kind, "is neither R nor W");
    r.write = kind == "W";
    if (!time.empty()) r.earliest = parse_time(time);
    if (!more.empty()) refuse(more, "is one word too many");
    return r;
  }

  sim::Time parse_time(std::string_view text) const {
    double ns = -1;
    const auto [rest, bad] = std::from_chars(text.data(), text.data() + text.size(), ns);
    if (bad != std::errc{} || rest != text.data() + text.size() || !(ns >= 0 && ns <= kLatestNs))
      refuse(text, "is not a time from 0 to 1e9 ns");
    return static_cast<sim::Time>(std::llround(ns * sim::kFemtosecondsPerNs));
  }

  [[noreturn]] void refuse(std::string_view word, std::string_view what) const {
    throw sim::InputError(fmt::format("{}:{}: '{}' {}; {}", name_, number_, sim::printable(word), what, kAllowed));
  }

  std::string_view rest_, line_;
  std::string name_;
  std::size_t number_ = 0;
};

}  // namespace

std::vector<hw::DramRequest> load_dram_stream(const std::string& file) {
  const std::string text = file == "-" ? read_standard_input() : sim::read_file(file, kMostBytes);
  return StreamParser(text, file == "-" ? "standard input" : file).parse_all();
}

namespace {

using sim::Json;

double nanoseconds_of(sim::Time time) { return static_cast<double>(time) / sim::kFemtosecondsPerNs; }

/// Latency statistics of DRAM requests, in ns.
struct Latencies {
  static constexpr std::array<const char*, 6> kNames = {"min", "p50", "p90", "p99", "max", "mean"};
  std::array<double, 6> values{};
  std::size_t count = 0;

  explicit Latencies(std::vector<double> all) : count(all.size()) {
    if (all.empty()) return;
    double sum = 0;
    for (const double ns : all) sum += ns;
    const auto rank = [&](double part) {  // percentile by the nearest-rank method
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

/// Results of simulating a stream of DRAM requests.
struct Result {
  const hw::DramConfig& config;
  const hw::DramRun play;
  const std::uint32_t outstanding;
  Latencies all, reads, writes;

  Result(const hw::DramConfig& c, const std::vector<hw::DramRequest>& requests, std::uint32_t limit)
      : config(c),
        play(hw::run_dram_requests(c, requests, limit)),
        outstanding(limit),
        all(latencies_ns(requests, true, true)),
        reads(latencies_ns(requests, true, false)),
        writes(latencies_ns(requests, false, true)) {}

  double bandwidth_gbps() const { return static_cast<double>(play.stats.bytes) / nanoseconds_of(play.end); }
  double peak_gbps() const {
    return static_cast<double>(config.organisation.burst.bytes) /
           nanoseconds_of(config.timing.burst * config.timing.ck.time);
  }
  double hit_rate() const { return static_cast<double>(play.stats.row_hits) / static_cast<double>(all.count); }
  sim::Band pj_per_bit() const {
    return hw::dram_energy(config, play.stats) * (1 / (8 * static_cast<double>(play.stats.bytes)));
  }

 private:
  std::vector<double> latencies_ns(const std::vector<hw::DramRequest>& requests, bool of_reads, bool of_writes) const {
    std::vector<double> ns;
    for (std::size_t i = 0; i < requests.size(); ++i) {
      if (requests[i].write ? of_writes : of_reads) ns.push_back(nanoseconds_of(play.request_latency(i)));
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
  for (const sim::Time time : r.play.done) done.push_back(nanoseconds_of(time));
  return {{"schema", "raywatt-microbench-dram/1"},
          {"grade", r.config.grade},
          {"outstanding", r.outstanding},
          {"requests", r.all.count},
          {"reads", s.reads},
          {"writes", s.writes},
          {"time_ns", nanoseconds_of(r.play.end)},
          {"bandwidth_gbps", r.bandwidth_gbps()},
          {"peak_gbps", r.peak_gbps()},
          {"bandwidth_of_peak", r.bandwidth_gbps() / r.peak_gbps()},
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
  line("time", fmt::format("{:.3f} us", nanoseconds_of(r.play.end) / 1000));
  line("bandwidth", fmt::format("{:.3f} GB/s ({:.1f} % of {:.2f} GB/s)", r.bandwidth_gbps(),
                                100 * r.bandwidth_gbps() / r.peak_gbps(), r.peak_gbps()));
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

Measurement::Relation relation_of(hw::DramMeasurement::Agreement agreement) {
  using Agreement = hw::DramMeasurement::Agreement;
  switch (agreement) {
    case Agreement::kExactly:
      return Measurement::Relation::kExactly;
    case Agreement::kClosely:
      return Measurement::Relation::kClosely;
    case Agreement::kNearly:
      return Measurement::Relation::kNearly;
    case Agreement::kAtMost:
      break;
  }
  return Measurement::Relation::kAtMost;
}

hw::DramConfig dram_config_of(const BenchmarkJob& job, const JobOptions& machine) {
  hw::DramConfig config = load_run_config(machine).gpu->dram;
  if (job.refresh == "off") config.timing.refi_pb = config.timing.refi_ab = 0;
  return config;
}

void add(Findings& findings, const std::string& prefix, const std::vector<hw::DramMeasurement>& measured) {
  for (const hw::DramMeasurement& f : measured)
    findings.measurements.push_back({prefix + f.name, f.unit, f.measured, f.expected, relation_of(f.agreement)});
}

/// Returns the energy of one DRAM channel for each grade in configs/dram.
Findings energies_of_grades(const BenchmarkJob& job) {
  Findings findings{"energy of a channel of each grade", {}};
  for (const JobOptions& of_grade : jobs_with_all_dram_grades(job.machine)) {
    const hw::DramConfig config = dram_config_of(job, of_grade);
    add(findings, config.grade + ", ", hw::dram_energy_measurements(config));
  }
  return findings;
}

Findings measure_channel(const BenchmarkJob& job) {
  if (job.all_grades && !job.stream.empty()) {
    throw sim::InputError("--all-grades and --stream exclude each other; allowed: one of them");
  }
  if (job.all_grades) return energies_of_grades(job);
  const hw::DramConfig config = dram_config_of(job, job.machine);
  if (job.stream.empty()) {
    Findings findings{config.grade + ", a channel", {}};
    add(findings, "", hw::dram_measurements(config));
    return findings;
  }
  const std::vector<hw::DramRequest> requests = load_dram_stream(job.stream);
  const Result result(config, requests, job.outstanding == 0 ? config.controller.read_queue : job.outstanding);
  return {.title = {},
          .measurements = {},
          .printed = job.json ? sim::json_lines(stream_json(result)) : stream_text(result)};
}

}  // namespace

Benchmark dram_benchmark() {
  return {
      "dram",
      "Latency, bandwidth and energy of one memory channel, or the time of each request of a file",
      "All requests go to one channel, in the order of the file. Addresses are within the channel: they have no "
      "channel\n"
      "bits, and bits above the capacity are ignored. A request is for the line (dram.line) of its byte. It is done\n"
      "when the last of its data has passed the bus; dram.fabric is not included. Time 0 is when the first request "
      "may\n"
      "reach the channel. Percentiles are by nearest rank.\n"
      "\n"
      "Example: raywatt microbench dram --stream requests.txt --outstanding 16 --refresh off\n"
      "Example: raywatt microbench dram --set dram.extends=dram/lpddr5-6400\n"
      "Example: raywatt microbench dram --all-grades",
      {{"--stream",
        "simulate this file, or standard input if it is -. A line is a hexadecimal address, R or W, and\n"
        "optionally the earliest time in ns. Without it: a table of measurements and closed forms",
        &BenchmarkJob::stream},
       {"--outstanding",
        "maximum number of requests in flight; a write ends when the channel accepts it\n(default: "
        "dram.controller.read_queue)",
        &BenchmarkJob::outstanding,
        false,
        {},
        65536},
       {"--all-grades", "measure the energy of each speed grade in configs/dram", &BenchmarkJob::all_grades},
       {"--refresh", "off: no refreshes", &BenchmarkJob::refresh, true, {"on", "off"}},
       {"--json", "print JSON, with every request's completion time", &BenchmarkJob::json}},
      measure_channel};
}

}  // namespace tools
