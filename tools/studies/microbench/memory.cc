#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "hw_models/dram/dram_config.h"
#include "hw_models/dram/dram_measurements.h"
#include "hw_models/machines/gpu.h"
#include "hw_models/machines/memory_system.h"
#include "hw_models/memory/cache.h"
#include "sim/engine.h"
#include "sim/link.h"
#include "sim/report/table.h"
#include "sim/time.h"
#include "tools/studies/microbench/benchmark.h"

namespace tools {

/// Test client that reads cache lines in order through a first-level cache, with one probe per cycle if an MSHR is
/// free.
///
///  reads, in order --> [L1: tags, MSHRs] --> request link;  response link --> fill
///
/// Two reads of the same line must not be in flight together, because only one read can wait for a line.
class Reader {
 public:
  struct Read {
    hw::Addr line = 0;
    sim::Time earliest = 0;
    sim::Time probed = 0;   ///< time at which the cache is probed
    sim::Time arrived = 0;  ///< time at which the data arrive; equal to `probed` for a hit
  };

  Reader(sim::Clock clock, const hw::CacheConfig& cache, std::uint16_t source, sim::Link<hw::MemRequest>& out,
         sim::Link<hw::MemResponse>& in)
      : clock_(clock), l1_(cache, source), out_(out), in_(in) {}

  void add_read(hw::Addr line, sim::Time earliest = 0) { reads_.push_back({line, earliest}); }
  const std::vector<Read>& timed_reads() const { return reads_; }
  bool done() const { return finished_ == reads_.size(); }

  // Called by the engine.
  const sim::Clock& clock() const { return clock_; }
  sim::Time tick(sim::Time now) {
    if (in_.can_pop(now)) {
      reads_[l1_.fill_line(in_.pop(now).line).requested_at].arrived = now;
      finished_ += 1;
    }
    if (may_read() && reads_[next_].earliest <= now) read_next(now);
    l1_.send_request(now, out_);
    const sim::Time next = clock_.edge_after(now, 1);
    sim::Time wake = std::max(next, in_.pop_at());
    if (may_read()) wake = std::min(wake, std::max(next, clock_.edge_at_or_after(reads_[next_].earliest)));
    return std::min(wake, l1_.next_send_time(next, out_));
  }

 private:
  bool may_read() const { return next_ < reads_.size() && !l1_.is_full(); }
  void read_next(sim::Time now) {
    Read& read = reads_[next_];
    read.probed = now;
    // The number stored with a miss, normally its cycle, is here the index of the read. The fill returns it.
    if (l1_.access_line(read.line, 0, next_) == hw::L1Cache::Result::kHit) {
      read.arrived = now;
      finished_ += 1;
    }
    next_ += 1;
  }

  sim::Clock clock_;
  hw::L1Cache l1_;
  sim::Link<hw::MemRequest>& out_;
  sim::Link<hw::MemResponse>& in_;
  std::vector<Read> reads_;
  std::size_t next_ = 0, finished_ = 0;
};

/// The memory level at which a read finds its line; for DRAM the state of the bank.
enum class Level : std::uint8_t { kL2, kRowOpen, kBankClosed, kOtherRow };

/// Formulas for latencies and rates of a machine's memory system without contention.
class MemoryForms {
 public:
  explicit MemoryForms(const hw::GpuConfig& config)
      : c_(config),
        dram_forms_(config.dram),
        tni_(config.clocks.tni.clock()),
        l2_(config.clocks.l2.clock()),
        dram_(config.dram.timing.ck.time) {}

  /// Returns the time at which the cache line arrives for a read that missed in the L1 at `probed`. The read passes
  /// wire, port, interconnect and bank, and the line returns. Each clock crossing is rounded up to the next clock edge.
  sim::Time line_return_time(sim::Time probed, Level level) const {
    const sim::Time at_bank = cross_clocks(probed, tni_, 1, l2_) + c_.interconnect.latency * l2_.period();
    const sim::Time answered = level == Level::kL2 ? at_bank + c_.l2.cache.hit_cycles * l2_.period()
                                                   : fill_time(at_bank, level) + l2_.period();
    return cross_clocks(answered + c_.interconnect.latency * l2_.period(), l2_, 1, tni_);
  }
  /// Returns the time in fs for which a miss occupies an MSHR of the L2, averaged over all clock phases.
  double l2_mshr_time(Level level) const {
    sim::Time sum = 0;
    for (std::uint32_t i = 0; i < kRounds; ++i) sum += fill_time(i * l2_.period(), level) - i * l2_.period();
    return static_cast<double>(sum) / kRounds;
  }

  // Upper bounds of the line rate, in lines per second.
  UpperBound port_rate(std::uint32_t cores) const {
    const auto cycles = static_cast<double>(c_.interconnect.cycles_of(c_.l2.cache.line.bytes));
    return {cores * per_second(l2_) / cycles, "core ports"};
  }
  UpperBound l2_line_rate() const { return {c_.l2.banks * per_second(l2_), "L2 lines"}; }
  UpperBound l2_mshr_rate(Level level) const {
    return {c_.l2.cache.mshrs / l2_mshr_time(level) * kPerSecond, "L2 miss registers"};
  }
  /// Returns the upper bound of the line rate that is due to `mshrs` MSHRs of a first-level cache. Each MSHR handles
  /// one miss after the other. The misses start in consecutive cycles, so their clock phases differ. The bound is
  /// marked as not reached if the L2 has another clock.
  UpperBound l1_mshr_rate(std::uint32_t mshrs, Level level) const {
    const std::uint32_t starts = std::min(mshrs, 64U);
    double rate = 0;
    for (std::uint32_t i = 0; i < starts; ++i) {
      const sim::Time start = i * tni_.period();
      sim::Time at = start;
      for (std::uint32_t round = 0; round < kRounds; ++round) at = line_return_time(at, level);
      rate += kRounds * kPerSecond / static_cast<double>(at - start);
    }
    return {rate * mshrs / starts, "L1 miss registers", tni_ == l2_};
  }
  /// Returns the upper bound of the line rate that is due to the wire from a client to its core port. One request per
  /// cycle crosses into the port's clock. A slot of the wire is free again a port cycle after the port has taken the
  /// request.
  UpperBound request_wire_rate() const {
    std::array<sim::Time, hw::kRequestDepth> free{};
    sim::Time pushed = 0, taken = 0;
    for (std::uint32_t i = 0; i < kRounds; ++i) {
      sim::Time& slot = free[i % free.size()];
      pushed = std::max(pushed + tni_.period(), slot);
      taken = std::max(taken + l2_.period(), cross_clocks(pushed, tni_, 1, l2_));
      slot = tni_.edge_at_or_after(taken + l2_.period());
    }
    return {kRounds * kPerSecond / static_cast<double>(pushed), "request wire"};
  }
  UpperBound stream_rate() const { return {channel_line_rate(dram_forms_.cycles_per_streamed_line()), "DRAM"}; }
  UpperBound own_row_line_rate() const {
    return {channel_line_rate(dram_forms_.cycles_per_line_of_row_stream(1)), "DRAM"};
  }

 private:
  static constexpr double kPerSecond = static_cast<double>(sim::kFemtosecondsPerSecond);
  static constexpr std::uint32_t kRounds = 4000;

  sim::Time cross_clocks(sim::Time at, sim::Clock from, std::uint64_t cycles, sim::Clock to) const {
    const sim::Time there = at + cycles * from.period();
    return from == to ? there : to.edge_at_or_after(there + c_.clocks.synchroniser * to.period());
  }
  /// Returns the time at which the L2 bank receives the line of a miss from memory. `at_bank`: time of the lookup in
  /// the L2 bank.
  sim::Time fill_time(sim::Time at_bank, Level level) const {
    const sim::Time arrived = cross_clocks(at_bank + c_.l2.lookup_cycles * l2_.period(), l2_, 1, dram_);
    const double device = level == Level::kRowOpen      ? dram_forms_.row_hit_latency()
                          : level == Level::kBankClosed ? dram_forms_.closed_bank_latency()
                                                        : dram_forms_.row_conflict_latency();
    const sim::Time fabric = dram_.edge_at_or_after(c_.dram.fabric.time);
    return cross_clocks(arrived + static_cast<sim::Time>(device) * dram_.period() + fabric, dram_, 1, l2_);
  }
  static double per_second(sim::Clock clock) { return kPerSecond / static_cast<double>(clock.period()); }
  double channel_line_rate(double cycles) const { return c_.dram.channels * per_second(dram_) / cycles; }

  const hw::GpuConfig c_;
  const hw::DramClosedForms dram_forms_;
  const sim::Clock tni_, l2_, dram_;
};

namespace {

struct CacheInClock {
  sim::Clock clock;
  const hw::CacheConfig& cache;
};

/// Returns the first-level caches of a core with their clocks.
std::vector<CacheInClock> first_level_caches(const hw::GpuConfig& config) {
  const sim::Clock tni = config.clocks.tni.clock();
  std::vector<CacheInClock> all(config.tni.trvs, {tni, config.tni.trv.l1});
  all.push_back({tni, config.tni.ist.l1});
  all.push_back({config.clocks.srp.clock(), config.srp.data_cache});
  return all;
}

}  // namespace

/// The memory system of a machine, with a Reader (test client with an L1) for every first-level cache. A core has one
/// Reader per traversal unit, one for the intersection unit and one for the shader core.
class MemorySide {
 public:
  /// `config` must outlive this object.
  explicit MemorySide(const hw::GpuConfig& config)
      : clients_(config.tni.trvs + 2),
        machine_(config.clocks.synchroniser),
        memory_(machine_, config, hw::MemorySystem::Dma::kNo) {
    for (std::uint32_t core = 0; core < config.cores; ++core) {
      memory_.declare_ports();
      for (const auto& [clock, cache] : first_level_caches(config)) {
        const sim::UnitId unit = machine_.unit({hw::unit_name_in_core("core.reader", core), clock, core + 1});
        const hw::MemoryPort port = memory_.add_cache_client(core, {unit, cache.mshrs});
        readers_.push_back(&machine_.build<Reader>(unit, clock, cache, port.client, port.requests, port.responses));
      }
      memory_.build_ports(core);
    }
    memory_.build_banks_and_channels();
  }
  MemorySide(const MemorySide&) = delete;
  MemorySide& operator=(const MemorySide&) = delete;

  Reader& reader_of(std::uint32_t core, std::uint32_t client) { return *readers_[core * clients_ + client]; }
  const std::vector<Reader*>& all_readers() const { return readers_; }
  /// Simulates all reads. Throws sim::Deadlock if they never end.
  void run() { sim::run(*this); }

  // Called by the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const {
    return std::ranges::all_of(readers_, [](const Reader* reader) { return reader->done(); });
  }

 private:
  const std::uint32_t clients_;
  sim::Machine machine_;
  hw::MemorySystem memory_;
  std::vector<Reader*> readers_;
};

namespace {

constexpr std::uint32_t kPhases = 20;  // number of start cycles that are measured, to cover all clock phases

/// Returns the first address after 0 in the same DRAM channel and bank as address 0. `same_row`: in the same row, else
/// in another one. Returns nothing if there is none.
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

/// Measures the latency of single reads of an idle memory system.
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
  /// Reads `lines` one after the other and adds the latency of the last read to `measurement`, from the L1 probe to the
  /// data. `neighbour_first`: another client of the core reads the last line before. `level`: memory level that serves
  /// the last read; empty: the L1.
  void measure_read(Measurement& measurement, std::uint32_t phase, const std::vector<hw::Addr>& lines,
                    bool neighbour_first, std::optional<Level> level) const {
    MemorySide side(config_);
    Reader& reader = side.reader_of(0, 0);
    sim::Time at = phase * clock_.period();
    if (neighbour_first) side.reader_of(0, config_.tni.trvs).add_read(lines.back(), at);
    for (const hw::Addr line : lines) reader.add_read(line, at += pause_);
    side.run();
    const Reader::Read& last = reader.timed_reads().back();
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
          [](const BenchmarkJob& job) { return Chase(*non_ideal_machine(job.machine).gpu).measure_levels(); }};
}

namespace {

constexpr std::uint32_t kLines = 40'000;
constexpr std::uint32_t kLineBits = 22;  // number of address bits of random lines

/// Returns a pseudo-random permutation of the numbers below 2^kLineBits.
std::uint32_t scatter_line(std::uint32_t i) {
  constexpr std::uint32_t kMask = (1U << kLineBits) - 1;
  for (const std::uint32_t odd : {0x2c1b3c6dU, 0x297a2d39U}) {
    i ^= i >> (kLineBits / 2);
    i = i * odd & kMask;
  }
  return i ^ i >> (kLineBits / 2);
}

/// Returns the measured bandwidth in GB/s of reading consecutive or random lines. The readers of all cores share one
/// stream of lines, interleaved.
double measured_gbps(const hw::GpuConfig& config, bool random) {
  MemorySide side(config);
  const auto readers = static_cast<std::uint32_t>(side.all_readers().size());
  for (std::uint32_t i = 0; i < kLines / readers * readers; ++i)
    side.all_readers()[i % readers]->add_read((random ? scatter_line(i) : i) * config.l2.cache.line.bytes);
  side.run();
  std::vector<sim::Time> moments;
  for (const Reader* reader : side.all_readers()) {
    for (const Reader::Read& read : reader->timed_reads()) moments.push_back(read.arrived);
  }
  return steady_rate(moments) * static_cast<double>(config.l2.cache.line.bytes) / 1e9;
}

Measurement measure_machine(const hw::GpuConfig& config, bool random) {
  const MemoryForms forms(config);
  const Level level = random ? Level::kBankClosed : Level::kRowOpen;
  const std::uint32_t mshrs = config.cores * (config.tni.trvs * config.tni.trv.l1.mshrs + config.tni.ist.l1.mshrs +
                                              config.srp.data_cache.mshrs);
  const UpperBound bound =
      tightest_bound({forms.port_rate(config.cores), forms.l2_line_rate(), forms.l1_mshr_rate(mshrs, level),
                      forms.l2_mshr_rate(level), random ? forms.own_row_line_rate() : forms.stream_rate()});
  return {fmt::format("{}, {}", config.dram.grade, random ? "random" : "stream"),
          "GB/s",
          measured_gbps(config, random),
          bound.value * static_cast<double>(config.l2.cache.line.bytes) / 1e9,
          Measurement::Relation::kAtMost,
          std::string(bound.by)};
}

Findings measure_bandwidth(const JobOptions& job, bool all_grades) {
  std::vector<hw::GpuConfig> machines;
  if (!all_grades) machines.push_back(*non_ideal_machine(job).gpu);
  for (const JobOptions& of_grade : all_grades ? jobs_with_all_dram_grades(job) : std::vector<JobOptions>{}) {
    machines.push_back(*non_ideal_machine(of_grade).gpu);
  }
  Findings found{"lines read through the L2", {}};
  for (const hw::GpuConfig& config : machines) {
    for (const bool random : {false, true}) found.measurements.push_back(measure_machine(config, random));
  }
  return found;
}

}  // namespace

Benchmark bandwidth_benchmark() {
  return {"bandwidth",
          "Lines per second from DRAM through the L2 to all cores, streamed and random",
          "Every first-level cache of every core requests lines that no cache has, as fast as its MSHRs allow.\n"
          "The bound is the smallest of the rates of ports, caches, MSHRs and DRAM. Queues, bank waits and\n"
          "refreshes reduce the measured rate.\n"
          "\n"
          "Example: raywatt microbench bandwidth --all-grades --set cores=8",
          {json_option(), {"--all-grades", "measure with each speed grade in configs/dram", &BenchmarkJob::all_grades}},
          [](const BenchmarkJob& job) { return measure_bandwidth(job.machine, job.all_grades); }};
}

namespace {

constexpr std::uint32_t kMissedLines = 8000;
constexpr sim::Time kWarm = sim::kFemtosecondsPerSecond;  // the measurement starts at this time, when the L2 is warm

/// Measures the misses per cycle that the L1 of one traversal unit sustains. `in_l2`: all misses hit in the L2.
double measured_misses_per_cycle(const hw::GpuConfig& config, bool in_l2) {
  MemorySide side(config);
  const std::uint64_t line = config.l2.cache.line.bytes;
  for (std::uint64_t i = 0; i < kMissedLines; ++i) {
    if (in_l2) side.reader_of(0, config.tni.trvs).add_read(i * line);
    side.reader_of(0, 0).add_read(i * line, in_l2 ? kWarm : 0);
  }
  side.run();
  std::vector<sim::Time> moments;
  for (const Reader::Read& read : side.reader_of(0, 0).timed_reads()) moments.push_back(read.arrived);
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
      std::vector<UpperBound> bounds = {forms.l1_mshr_rate(mshrs, level), forms.port_rate(1), forms.l2_line_rate(),
                                        forms.request_wire_rate()};
      if (!in_l2) {
        bounds.push_back(forms.l2_mshr_rate(level));
        bounds.push_back(forms.stream_rate());
      }
      const UpperBound bound = tightest_bound(bounds);
      found.measurements.push_back(
          {fmt::format("{} miss register{}, lines in {}", mshrs, mshrs == 1 ? "" : "s", in_l2 ? "the L2" : "DRAM"),
           "M/s", measured_misses_per_cycle(config, in_l2), bound.value / 1e6,
           in_l2 ? bound.required_relation() : Measurement::Relation::kAtMost, std::string(bound.by)});
    }
  }
  return found;
}

}  // namespace

Benchmark mshr_benchmark() {
  return {"mshr",
          "Misses per second of one first-level cache, by its number of MSHRs",
          "The cache of one traversal unit misses as fast as it can; all other units are idle. The L2 has a constant\n"
          "latency, so the closed form is exact. A line in DRAM sometimes opens a row, which the form ignores.\n"
          "There are no refreshes and no power-down, and the L2 is large enough.\n"
          "\n"
          "Example: raywatt microbench mshr --set l2.hit_cycles=40",
          {json_option()},
          [](const BenchmarkJob& job) { return measure_misses(*non_ideal_machine(job.machine).gpu); }};
}

}  // namespace tools
