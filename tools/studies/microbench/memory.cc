#include <optional>

#include <fmt/format.h>

#include "hw_models/dram/dram_config.h"
#include "sim/report/table.h"
#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/microbench/memory_side.h"

namespace tools {
namespace {

constexpr std::uint32_t kPhases = 20;  // start times in consecutive cycles, to cover all clock phases

/// Returns the first line after line 0 in its channel and bank, in the same row or in another.
std::optional<hw::Addr> find_line(const hw::DramConfig& dram, bool same_row) {
  const hw::DramMap map(dram);
  const hw::DramAddress first = map.address_of(0);
  const hw::Addr end =
      4 * dram.channels * dram.organisation.page.bytes * dram.organisation.all_banks() * dram.organisation.all_banks();
  for (hw::Addr line = dram.line.bytes; line < end; line += dram.line.bytes) {
    const hw::DramAddress address = map.address_of(line);
    if (dram.channel_interleave().index_of(line) == 0 && address.bank == first.bank &&
        (address.row == first.row) == same_row)
      return line;
  }
  return std::nullopt;
}

/// Measures single reads, with pauses so that the memory is idle before each.
class Chase {
 public:
  explicit Chase(const hw::GpuConfig& config)
      : config_(config),
        forms_(config),
        clock_(config.clocks.tni.clock()),
        pause_(8192 * (config.dram.timing.ck.time + config.clocks.l2.clock().period() + clock_.period())) {
    config_.cores = 1;
    config_.dram.timing.refi_pb = config_.dram.timing.refi_ab = 0;
    config_.dram.controller.power_down = false;
    config_.dram.controller.page_policy = hw::PagePolicy::kOpen;
  }

  Findings measure_levels() const {
    Findings found{"a read, as a traversal unit sees it", {}};
    const auto add = [&](const char* name, auto&& make) {
      Measurement f{name, "ns"};
      for (std::uint32_t phase = 0; phase < kPhases; ++phase) make(f, 1 + phase);
      found.measurements.push_back(f);
    };
    const auto row_open = find_line(config_.dram, true), other_row = find_line(config_.dram, false);
    add("L1 hit", [&](Measurement& f, std::uint32_t phase) { measure_read(f, phase, {0, 0}, false, std::nullopt); });
    add("L2 hit", [&](Measurement& f, std::uint32_t phase) { measure_read(f, phase, {0}, true, Level::kL2); });
    if (row_open) {
      add("DRAM, row open", [&](Measurement& f, std::uint32_t phase) {
        measure_read(f, phase, {0, *row_open}, false, Level::kRowOpen);
      });
    }
    add("DRAM, bank closed",
        [&](Measurement& f, std::uint32_t phase) { measure_read(f, phase, {0}, false, Level::kBankClosed); });
    if (other_row) {
      add("DRAM, other row open", [&](Measurement& f, std::uint32_t phase) {
        measure_read(f, phase, {0, *other_row}, false, Level::kOtherRow);
      });
    }
    return found;
  }

 private:
  /// Reads the lines in order and adds the latency of the last read, from the probe of the L1 to its data.
  /// `neighbour_first`: another client has read the last line before. Without `level` the read hits the L1.
  void measure_read(Measurement& measurement, std::uint32_t phase, const std::vector<hw::Addr>& lines,
                    bool neighbour_first, std::optional<Level> level) const {
    MemorySide side(config_);
    Reader& reader = side.reader_of(0, 0);
    sim::Time at = phase * clock_.period();
    if (neighbour_first) side.reader_of(0, config_.tni.trvs).add_read(lines.back(), at);
    for (const hw::Addr line : lines) reader.add_read(line, at += pause_);
    side.run();
    const Reader::Read& last = reader.all_reads().back();
    const sim::Time hit = config_.tni.trv.l1.hit_cycles * clock_.period();
    const sim::Time expected = (level ? forms_.line_return_time(last.probed, *level) - last.probed : 0) + hit;
    measurement.measured += static_cast<double>(last.arrived - last.probed + hit) / sim::kFemtosecondsPerNs / kPhases;
    measurement.expected += static_cast<double>(expected) / sim::kFemtosecondsPerNs / kPhases;
  }

  hw::GpuConfig config_;
  const MemoryForms forms_;
  const sim::Clock clock_;
  const sim::Time pause_;
};

}  // namespace

Benchmark chase_benchmark() {
  return {"chase",
          "Latency of a single read that hits L1, L2 or DRAM, as a traversal unit sees it",
          "Each value is the mean over all clock phases of the start. Rows stay open, and there are no refreshes\n"
          "and no power-down.\n"
          "\n"
          "Example: raywatt microbench chase --set clocks.l2='800 MHz' --set interconnect.latency=8",
          {json_option()},
          [](const BenchmarkJob& job) { return Chase(*real_machine(job.machine).gpu).measure_levels(); }};
}

namespace {

constexpr std::uint32_t kLines = 40'000;
constexpr std::uint32_t kLineBits = 22;  // address bits of random lines

/// Permutes the numbers below 2^kLineBits: the bits are folded and multiplied, twice.
std::uint32_t scatter_line(std::uint32_t i) {
  constexpr std::uint32_t kMask = (1U << kLineBits) - 1;
  for (const std::uint32_t odd : {0x2c1b3c6dU, 0x297a2d39U}) {
    i ^= i >> (kLineBits / 2);
    i = i * odd & kMask;
  }
  return i ^ i >> (kLineBits / 2);
}

/// Returns the bandwidth of a stream of lines that all readers of all cores share, interleaved.
double measured_gbps(const hw::GpuConfig& config, bool random) {
  MemorySide side(config);
  const auto readers = static_cast<std::uint32_t>(side.all_readers().size());
  for (std::uint32_t i = 0; i < kLines / readers * readers; ++i)
    side.all_readers()[i % readers]->add_read((random ? scatter_line(i) : i) * config.l2.cache.line.bytes);
  side.run();
  std::vector<sim::Time> moments;
  for (const Reader* reader : side.all_readers()) {
    for (const Reader::Read& read : reader->all_reads()) moments.push_back(read.arrived);
  }
  return steady_rate(moments) * static_cast<double>(config.l2.cache.line.bytes) / 1e9;
}

Measurement measure_machine(const hw::GpuConfig& config, bool random) {
  const MemoryForms forms(config);
  const Level level = random ? Level::kBankClosed : Level::kRowOpen;
  const std::uint32_t mshrs = config.cores * (config.tni.trvs * config.tni.trv.l1.mshrs + config.tni.ist.l1.mshrs +
                                              config.srp.data_cache.mshrs);
  const UpperBound bound =
      tightest_bound({forms.port_rate(config.cores), forms.l2_lines(), forms.l1_mshrs(mshrs, level),
                      forms.l2_mshrs(level), random ? forms.lines_of_own_row() : forms.stream_rate()});
  return {fmt::format("{}, {}", config.dram.grade, random ? "random" : "stream"),
          "GB/s",
          measured_gbps(config, random),
          bound.value * static_cast<double>(config.l2.cache.line.bytes) / 1e9,
          Measurement::Relation::kAtMost,
          std::string(bound.by)};
}

Findings measure_bandwidth(const JobOptions& job, bool all_grades) {
  std::vector<hw::GpuConfig> machines;
  if (!all_grades) machines.push_back(*real_machine(job).gpu);
  for (const JobOptions& of_grade : all_grades ? jobs_of_all_grades(job) : std::vector<JobOptions>{}) {
    machines.push_back(*real_machine(of_grade).gpu);
  }
  Findings found{"lines read through the L2", {}};
  for (const hw::GpuConfig& config : machines) {
    for (const bool random : {false, true}) found.measurements.push_back(measure_machine(config, random));
  }
  return found;
}

}  // namespace

Benchmark bandwidth_benchmark() {
  return {
      "bandwidth",
      "Lines per second from DRAM through the L2 to all cores, streamed and random",
      "Every first-level cache of every core requests lines that no cache has, as fast as its miss registers allow.\n"
      "The bound is the smallest of the rates of ports, caches, miss registers and DRAM. Queues, bank waits and\n"
      "refreshes reduce the measured rate.\n"
      "\n"
      "Example: raywatt microbench bandwidth --all-grades --set cores=8",
      {json_option(), {"--all-grades", "for each speed grade in configs/dram", &BenchmarkJob::all_grades}},
      [](const BenchmarkJob& job) { return measure_bandwidth(job.machine, job.all_grades); }};
}

namespace {

constexpr std::uint32_t kMissedLines = 8000;
constexpr sim::Time kWarm = sim::kFemtosecondsPerSecond;  // start of the measurement, after the L2 is warm

/// Returns the greatest number of misses per cycle that the cache of one traversal unit sustains.
double measured_rate(const hw::GpuConfig& config, bool in_l2) {
  MemorySide side(config);
  const std::uint64_t line = config.l2.cache.line.bytes;
  for (std::uint64_t i = 0; i < kMissedLines; ++i) {
    if (in_l2) side.reader_of(0, config.tni.trvs).add_read(i * line);
    side.reader_of(0, 0).add_read(i * line, in_l2 ? kWarm : 0);
  }
  side.run();
  std::vector<sim::Time> moments;
  for (const Reader::Read& read : side.reader_of(0, 0).all_reads()) moments.push_back(read.arrived);
  return steady_rate(moments) / 1e6;
}

Findings measure_misses(hw::GpuConfig config) {
  config.cores = 1;
  config.dram.timing.refi_pb = config.dram.timing.refi_ab = 0;
  config.dram.controller.power_down = false;
  config.dram.controller.page_policy = hw::PagePolicy::kOpen;
  while (config.l2.cache.size.bytes < 2 * kMissedLines * config.l2.cache.line.bytes) config.l2.cache.size.bytes *= 2;
  const MemoryForms forms(config);
  Findings found{"misses of one L1", {}};
  for (const bool in_l2 : {true, false}) {
    for (std::uint32_t mshrs = 1; mshrs <= 64; mshrs *= 2) {
      config.tni.trv.l1.mshrs = mshrs;
      const Level level = in_l2 ? Level::kL2 : Level::kRowOpen;
      std::vector<UpperBound> bounds = {forms.l1_mshrs(mshrs, level), forms.port_rate(1), forms.l2_lines(),
                                        forms.request_wire()};
      if (!in_l2) {
        bounds.push_back(forms.l2_mshrs(level));
        bounds.push_back(forms.stream_rate());
      }
      const UpperBound bound = tightest_bound(bounds);
      found.measurements.push_back(
          {fmt::format("{} miss register{}, lines in {}", mshrs, mshrs == 1 ? "" : "s", in_l2 ? "the L2" : "DRAM"),
           "M/s", measured_rate(config, in_l2), bound.value / 1e6,
           in_l2 ? bound.required_relation() : Measurement::Relation::kAtMost, std::string(bound.by)});
    }
  }
  return found;
}

}  // namespace

Benchmark mshr_benchmark() {
  return {"mshr",
          "Misses per second of one first-level cache, by its number of miss registers",
          "The cache of one traversal unit misses as fast as it can; all other units are idle. The L2 has a constant\n"
          "latency, so the closed form is exact. A line in DRAM sometimes opens a row, which the form ignores.\n"
          "There are no refreshes and no power-down, and the L2 is large enough.\n"
          "\n"
          "Example: raywatt microbench mshr --set l2.hit_cycles=40",
          {json_option()},
          [](const BenchmarkJob& job) { return measure_misses(*real_machine(job.machine).gpu); }};
}

}  // namespace tools
