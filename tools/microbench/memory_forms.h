#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/frame/gpu_config.h"
#include "hw_models/memory/dram_forms.h"
#include "sim/time.h"
#include "tools/microbench/figure.h"

namespace tools {

/// Where a line is found, as a traversal unit sees it.
enum class Level : std::uint8_t { kL2, kRowOpen, kBankClosed, kOtherRow };

/// What the memory side must take by its configuration, if nothing is in the way.
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
  /// Mean of back() - asked over the phases of the clocks, in fs.
  double latency(Level level) const {
    return mean([&](sim::Time t) { return back(tni_.edge_at_or_after(t), level) - tni_.edge_at_or_after(t); });
  }
  /// Mean time for which a miss keeps a register of the L2, in fs.
  double l2_register(Level level) const {
    return mean([&](sim::Time t) { return filled(l2_.edge_at_or_after(t), level) - l2_.edge_at_or_after(t); });
  }

  // Upper bounds, in lines per second.
  UpperBound ports(std::uint32_t cores) const {
    const auto cycles = static_cast<double>(c_.interconnect.cycles_of(c_.l2.cache.line.bytes));
    return {cores * per_second(l2_) / cycles, "core ports"};
  }
  UpperBound l2_lines() const { return {c_.l2.banks * per_second(l2_), "L2 lines"}; }
  UpperBound l2_registers(Level level) const {
    return {c_.l2.cache.mshrs / l2_register(level) * kPerSecond, "L2 miss registers"};
  }
  UpperBound registers(double count, Level level) const {
    return {count / latency(level) * kPerSecond, "L1 miss registers"};
  }
  UpperBound streamed() const { return {lines_of_channels(dram_forms_.streamed_line()), "DRAM"}; }
  UpperBound lines_of_own_row() const { return {lines_of_channels(dram_forms_.line_of_own_row(1)), "DRAM"}; }

 private:
  static constexpr double kPerSecond = static_cast<double>(sim::kFemtosecondsPerSecond);
  static constexpr std::uint32_t kPhases = 1000;

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
  double mean(auto&& of) const {
    double sum = 0;
    const sim::Time longest = std::max({tni_.period(), l2_.period(), dram_.period()});
    for (std::uint32_t i = 0; i < kPhases; ++i) sum += static_cast<double>(of(i * longest));
    return sum / kPhases;
  }
  static double per_second(sim::Clock clock) { return kPerSecond / static_cast<double>(clock.period()); }
  double lines_of_channels(double cycles) const { return c_.dram.channels * per_second(dram_) / cycles; }

  const hw::GpuConfig c_;
  const hw::DramForms dram_forms_;
  const sim::Clock tni_, l2_, dram_;
};

}  // namespace tools
