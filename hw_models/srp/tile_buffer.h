#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "hw_models/memory/unit_names.h"
#include "sim/activity.h"
#include "sim/config/field.h"
#include "sim/counter_kind.h"
#include "sim/named.h"
#include "sim/time.h"

namespace hw {

/// The on-chip memory of a core that holds everything its tiles in flight need.
struct TileBufferConfig {
  sim::ByteSize size{64 * 1024};
  std::uint32_t tiles_in_flight = 3;
  std::uint32_t slot_bytes = 64;
  std::uint32_t colour_bytes = 16;
  std::uint32_t banks = 16;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.size), "bytes", "storage of one core's tile buffer", sim::between(1024, 16 << 20), Affects::kTiming);
    field(NAMED(c.tiles_in_flight), "tiles", "tiles a core works on at once", sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.slot_bytes), "bytes", "a ray and the place reserved for its hit", sim::between(16, 256),
          Affects::kTiming);
    field(NAMED(c.colour_bytes), "bytes", "colour accumulator of a sample", sim::between(4, 64), Affects::kTiming);
    field(NAMED(c.banks), "banks", "16-byte banks that can be accessed in the same cycle", sim::power_of_two(1, 64),
          Affects::kTiming);
  }
};

/// Keeps account of the tile buffer: ray slots taken and given back, and the 16-byte accesses that cost energy.
/// A ray is made only into a free slot, which is also the place reserved for its hit; so hits never wait.
/// Conflicts of kernels for its banks are a matter of their schedules (bank_conflicts.h). Not modelled: conflicts with
/// the T&I unit's and the DMA's accesses.
class TileBuffer {
 public:
  static constexpr const char* kName = "core.tile_buffer";
  static constexpr Block kBlock = Block::kTileBuffer;
  enum class CycleReason : std::uint8_t { kIdle, kInUse, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle("idle", "no ray slot is taken")},
      {CycleReason::kInUse, sim::background("in_use", "ray slots are taken")},
  });
  struct Stats {
    std::uint64_t reads = 0, writes = 0, bank_conflicts = 0;
    std::uint64_t slots_taken = 0, slots_peak = 0, spilled_slots = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.reads), "16-byte reads", "tile.read");
      counter(NAMED(s.writes), "16-byte writes", "tile.write");
      counter(NAMED(s.bank_conflicts), "cycles for which a kernel stood still for a bank");
      counter(NAMED(s.slots_taken), "ray slots taken");
      counter(NAMED(s.slots_peak), "most ray slots in use at once", "", sim::CounterKind::kPeak);
      counter(NAMED(s.spilled_slots), "ray slots that did not fit and went through memory");
    }
  };

  /// Sets aside the colours of a full tile's `samples` and its `attribute_bytes` for every tile in flight. An ideal
  /// buffer has room for everything.
  TileBuffer(const TileBufferConfig& config, std::uint32_t samples, std::uint64_t attribute_bytes, sim::Clock clock,
             bool ideal = false)
      : clock_(clock), slot_bytes_(config.slot_bytes) {
    const std::uint64_t tile = std::uint64_t{samples} * config.colour_bytes + attribute_bytes;
    const std::uint64_t set_aside = config.tiles_in_flight * tile;
    slots_ = config.size.bytes > set_aside ? (config.size.bytes - set_aside) / config.slot_bytes : 0;
    if (ideal) slots_ = std::numeric_limits<std::uint64_t>::max();
  }

  std::uint64_t free() const { return used_ < slots_ ? slots_ - used_ : 0; }
  std::uint64_t used() const { return used_; }
  std::uint64_t slots() const { return slots_; }
  std::uint32_t slot_bytes() const { return slot_bytes_; }

  /// Takes `n` slots; returns how many of them do not fit.
  std::uint64_t take(std::uint64_t n) {
    const std::uint64_t spilled = n - std::min(n, free());
    used_ += n;
    stats_.slots_taken += n;
    stats_.slots_peak = std::max(stats_.slots_peak, used_);
    stats_.spilled_slots += spilled;
    return spilled;
  }
  void give_back(std::uint64_t n) { used_ -= n; }

  void read(std::uint64_t accesses) { stats_.reads += accesses; }
  void write(std::uint64_t accesses) { stats_.writes += accesses; }
  void conflict(std::uint64_t cycles) { stats_.bank_conflicts += cycles; }

  /// From `now` on the buffer is in use, or not.
  void in_use(sim::Time now, bool used) {
    const CycleReason why = used ? CycleReason::kInUse : CycleReason::kIdle;
    activity_.spend(now, clock_.period(), why, why);
  }
  void finish(sim::Time end) { activity_.finish(end); }

  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }

 private:
  sim::Clock clock_;
  std::uint32_t slot_bytes_;
  std::uint64_t slots_ = 0;
  std::uint64_t used_ = 0;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
