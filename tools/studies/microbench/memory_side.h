#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/dram/dram_measurements.h"
#include "hw_models/machines/gpu.h"
#include "hw_models/machines/memory_system.h"
#include "hw_models/memory/l1_cache.h"
#include "sim/link.h"
#include "sim/time.h"
#include "tools/studies/microbench/benchmark.h"

namespace tools {

/// A client that reads lines through a first-level cache: one probe per cycle while an MSHR is free.
///
///   reads, in order --> [L1: tags, MSHRs] --> request link;  response link --> fill
///
/// Reads of the same line must not overlap: waiters of a line are not stored.
class Reader {
 public:
  struct Read {
    hw::Addr line = 0;
    sim::Time earliest = 0;
    sim::Time probed = 0;   ///< time of the probe of the cache
    sim::Time arrived = 0;  ///< time of the data; equal to `probed` for a hit
  };

  Reader(sim::Clock clock, const hw::CacheConfig& cache, std::uint16_t source, sim::Link<hw::MemRequest>& out,
         sim::Link<hw::MemResponse>& in)
      : clock_(clock), l1_(cache, source), out_(out), in_(in) {}

  void add_read(hw::Addr line, sim::Time earliest = 0) { reads_.push_back({line, earliest}); }
  const std::vector<Read>& all_reads() const { return reads_; }
  bool done() const { return finished_ == reads_.size(); }

  // For the engine.
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
    // The cache stores the number of the read in place of the cycle of its miss.
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

/// The memory side of a machine with a Reader for every first-level cache. Readers of a core: one per traversal unit,
/// one for the intersection unit, one for the shader core.
class MemorySide {
 public:
  /// `config` must outlive it.
  explicit MemorySide(const hw::GpuConfig& config);
  MemorySide(const MemorySide&) = delete;
  MemorySide& operator=(const MemorySide&) = delete;

  Reader& reader_of(std::uint32_t core, std::uint32_t client) { return *readers_[core * clients_ + client]; }
  const std::vector<Reader*>& all_readers() const { return readers_; }
  /// Simulates all reads. sim::Deadlock if they do not end.
  void run();

  // For the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const;

 private:
  const std::uint32_t clients_;
  sim::Machine machine_;
  hw::MemorySystem memory_;
  std::vector<Reader*> readers_;
};

/// The level at which a read finds its line.
enum class Level : std::uint8_t { kL2, kRowOpen, kBankClosed, kOtherRow };

/// Closed forms of latencies and rates of the memory side without contention.
class MemoryForms {
 public:
  explicit MemoryForms(const hw::GpuConfig& config)
      : c_(config),
        dram_forms_(config.dram),
        tni_(config.clocks.tni.clock()),
        l2_(config.clocks.l2.clock()),
        dram_(config.dram.timing.ck.time) {}

  /// Returns the time at which the line of a miss at `probed` arrives: wire, port, interconnect, bank, and back. Each
  /// clock crossing is rounded up to the next edge.
  sim::Time line_return_time(sim::Time probed, Level level) const {
    const sim::Time at_bank = cross_clocks(probed, tni_, 1, l2_) + c_.interconnect.latency * l2_.period();
    const sim::Time answered = level == Level::kL2 ? at_bank + c_.l2.cache.hit_cycles * l2_.period()
                                                   : fill_time(at_bank, level) + l2_.period();
    return cross_clocks(answered + c_.interconnect.latency * l2_.period(), l2_, 1, tni_);
  }
  /// Returns the mean time that a miss occupies an MSHR of the L2, in fs, over all clock phases.
  double l2_mshr_time(Level level) const {
    sim::Time sum = 0;
    for (std::uint32_t i = 0; i < kRounds; ++i) sum += fill_time(i * l2_.period(), level) - i * l2_.period();
    return static_cast<double>(sum) / kRounds;
  }

  // Upper bounds, in lines per second.
  UpperBound port_rate(std::uint32_t cores) const {
    const auto cycles = static_cast<double>(c_.interconnect.cycles_of(c_.l2.cache.line.bytes));
    return {cores * per_second(l2_) / cycles, "core ports"};
  }
  UpperBound l2_lines() const { return {c_.l2.banks * per_second(l2_), "L2 lines"}; }
  UpperBound l2_mshrs(Level level) const {
    return {c_.l2.cache.mshrs / l2_mshr_time(level) * kPerSecond, "L2 miss registers"};
  }
  /// Misses of an MSHR are sequential. MSHRs start in consecutive cycles, so that their clock phases differ. With two
  /// clocks they may also delay each other.
  UpperBound l1_mshrs(std::uint32_t count, Level level) const {
    const std::uint32_t starts = std::min(count, 64U);
    double rate = 0;
    for (std::uint32_t i = 0; i < starts; ++i) {
      const sim::Time start = i * tni_.period();
      sim::Time at = start;
      for (std::uint32_t round = 0; round < kRounds; ++round) at = line_return_time(at, level);
      rate += kRounds * kPerSecond / static_cast<double>(at - start);
    }
    return {rate * count / starts, "L1 miss registers", tni_ == l2_};
  }
  /// Requests of a client cross into the clock of the port, one per cycle. A slot of the wire is free again when the
  /// client sees that the port has taken the request.
  UpperBound request_wire() const {
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
  UpperBound stream_rate() const { return {lines_of_channels(dram_forms_.cycles_per_streamed_line()), "DRAM"}; }
  UpperBound lines_of_own_row() const { return {lines_of_channels(dram_forms_.cycles_per_line_of_row(1)), "DRAM"}; }

 private:
  static constexpr double kPerSecond = static_cast<double>(sim::kFemtosecondsPerSecond);
  static constexpr std::uint32_t kRounds = 4000;

  sim::Time cross_clocks(sim::Time at, sim::Clock from, std::uint64_t cycles, sim::Clock to) const {
    const sim::Time there = at + cycles * from.period();
    return from == to ? there : to.edge_at_or_after(there + c_.clocks.synchroniser * to.period());
  }
  /// Returns the time at which the line is in the bank, after a lookup at `at_bank`.
  sim::Time fill_time(sim::Time at_bank, Level level) const {
    const sim::Time arrived = cross_clocks(at_bank + c_.l2.lookup_cycles * l2_.period(), l2_, 1, dram_);
    const double device = level == Level::kRowOpen      ? dram_forms_.row_hit_latency()
                          : level == Level::kBankClosed ? dram_forms_.closed_bank_latency()
                                                        : dram_forms_.row_conflict_latency();
    const sim::Time fabric = dram_.edge_at_or_after(c_.dram.fabric.time);
    return cross_clocks(arrived + static_cast<sim::Time>(device) * dram_.period() + fabric, dram_, 1, l2_);
  }
  static double per_second(sim::Clock clock) { return kPerSecond / static_cast<double>(clock.period()); }
  double lines_of_channels(double cycles) const { return c_.dram.channels * per_second(dram_) / cycles; }

  const hw::GpuConfig c_;
  const hw::DramClosedForms dram_forms_;
  const sim::Clock tni_, l2_, dram_;
};

}  // namespace tools
