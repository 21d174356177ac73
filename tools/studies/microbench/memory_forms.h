#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "hw_models/dram/dram_measurements.h"
#include "hw_models/machines/gpu.h"
#include "sim/time.h"
#include "tools/studies/microbench/figure.h"

namespace tools {

/// Where a line is found, as a traversal unit sees it.
enum class Level : std::uint8_t { kL2, kRowOpen, kBankClosed, kOtherRow };

/// Time that the memory side must take by its configuration, if nothing is in the way.
class MemoryForms {
 public:
  explicit MemoryForms(const hw::GpuConfig& config)
      : c_(config),
        dram_forms_(config.dram),
        tni_(config.clocks.tni.clock()),
        l2_(config.clocks.l2.clock()),
        dram_(config.dram.timing.ck.time) {}

  /// When a line is back that a client misses at `asked`: wire, port, distance, bank, ... and the same way back, with
  /// every crossing of clocks rounded up to the next edge.
  sim::Time back(sim::Time asked, Level level) const {
    const sim::Time at_bank = cross(asked, tni_, 1, l2_) + c_.interconnect.latency * l2_.period();
    const sim::Time answered =
        level == Level::kL2 ? at_bank + c_.l2.cache.hit_cycles * l2_.period() : filled(at_bank, level) + l2_.period();
    return cross(answered + c_.interconnect.latency * l2_.period(), l2_, 1, tni_);
  }
  /// Mean time for which a miss keeps an MSHR of the L2, in fs, over all ways in which the clocks can meet.
  double l2_mshr_time(Level level) const {
    sim::Time sum = 0;
    for (std::uint32_t i = 0; i < kRounds; ++i) sum += filled(i * l2_.period(), level) - i * l2_.period();
    return static_cast<double>(sum) / kRounds;
  }

  // Upper bounds, in lines per second.
  UpperBound ports(std::uint32_t cores) const {
    const auto cycles = static_cast<double>(c_.interconnect.cycles_of(c_.l2.cache.line.bytes));
    return {cores * per_second(l2_) / cycles, "core ports"};
  }
  UpperBound l2_lines() const { return {c_.l2.banks * per_second(l2_), "L2 lines"}; }
  UpperBound l2_mshrs(Level level) const {
    return {c_.l2.cache.mshrs / l2_mshr_time(level) * kPerSecond, "L2 miss registers"};
  }
  /// Each MSHR's misses follow each other; the first of them begin cycle by cycle, and so may meet the clocks in
  /// different ways for ever. Between two clocks they may also hinder each other.
  UpperBound l1_mshrs(std::uint32_t count, Level level) const {
    const std::uint32_t starts = std::min(count, 64U);
    double rate = 0;
    for (std::uint32_t i = 0; i < starts; ++i) {
      const sim::Time start = i * tni_.period();
      sim::Time at = start;
      for (std::uint32_t round = 0; round < kRounds; ++round) at = back(at, level);
      rate += kRounds * kPerSecond / static_cast<double>(at - start);
    }
    return {rate * count / starts, "L1 miss registers", tni_ == l2_};
  }
  /// A client's requests on their way into the port's clock, one a cycle; a slot on the wire is free again when the
  /// client sees that the port has taken the request.
  UpperBound request_wire() const {
    std::array<sim::Time, hw::kRequestDepth> free{};
    sim::Time pushed = 0, taken = 0;
    for (std::uint32_t i = 0; i < kRounds; ++i) {
      sim::Time& slot = free[i % free.size()];
      pushed = std::max(pushed + tni_.period(), slot);
      taken = std::max(taken + l2_.period(), cross(pushed, tni_, 1, l2_));
      slot = tni_.edge_at_or_after(taken + l2_.period());
    }
    return {kRounds * kPerSecond / static_cast<double>(pushed), "request wire"};
  }
  UpperBound streamed() const { return {lines_of_channels(dram_forms_.streamed_line()), "DRAM"}; }
  UpperBound lines_of_own_row() const { return {lines_of_channels(dram_forms_.line_of_own_row(1)), "DRAM"}; }

 private:
  static constexpr double kPerSecond = static_cast<double>(sim::kFemtosecondsPerSecond);
  static constexpr std::uint32_t kRounds = 4000;

  sim::Time cross(sim::Time at, sim::Clock from, std::uint64_t cycles, sim::Clock to) const {
    const sim::Time there = at + cycles * from.period();
    return from == to ? there : to.edge_at_or_after(there + c_.clocks.synchroniser * to.period());
  }
  /// When the line is in the bank that looked it up at `at_bank`.
  sim::Time filled(sim::Time at_bank, Level level) const {
    const sim::Time arrived = cross(at_bank + c_.l2.lookup_cycles * l2_.period(), l2_, 1, dram_);
    const double device = level == Level::kRowOpen      ? dram_forms_.row_hit()
                          : level == Level::kBankClosed ? dram_forms_.closed_bank()
                                                        : dram_forms_.row_conflict();
    const sim::Time fabric = dram_.edge_at_or_after(c_.dram.fabric.time);
    return cross(arrived + static_cast<sim::Time>(device) * dram_.period() + fabric, dram_, 1, l2_);
  }
  static double per_second(sim::Clock clock) { return kPerSecond / static_cast<double>(clock.period()); }
  double lines_of_channels(double cycles) const { return c_.dram.channels * per_second(dram_) / cycles; }

  const hw::GpuConfig c_;
  const hw::DramClosedForms dram_forms_;
  const sim::Clock tni_, l2_, dram_;
};

}  // namespace tools
