#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "hw_models/memory/unit_names.h"
#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/time.h"
#include "sim/unit_report.h"
#include "traces/stream.h"

namespace hw {

/// Configuration of a core's tile buffer, the on-chip memory for the data of the tiles that the core works on.
struct TileBufferConfig {
  sim::ByteSize size{64 * 1024};
  std::uint32_t tiles_in_flight = 3;
  double ray_share = 0;
  std::uint32_t tiles_in_pass = 3;
  std::uint32_t slot_bytes = 64;
  std::uint32_t colour_bytes = 16;
  std::uint32_t banks = 16;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.size), "bytes", "storage of one core's tile buffer", sim::between(1024, 16 << 20), Affects::kTiming);
    field(NAMED(c.tiles_in_flight), "tiles", "tiles that a core works on at once in a frame's first pass",
          sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.ray_share), "", "least share of the storage for ray slots; fewer tiles are in flight if necessary",
          sim::between(0, 0.95), Affects::kTiming);
    field(NAMED(c.tiles_in_pass), "tiles",
          "tiles that a core works on at once in later passes, if they fit in the space of the first pass's tiles",
          sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.slot_bytes), "bytes", "storage of a ray and its hit", sim::between(16, 256), Affects::kTiming);
    field(NAMED(c.colour_bytes), "bytes", "colour accumulator of a sample", sim::between(4, 64), Affects::kTiming);
    field(NAMED(c.banks), "banks", "16-byte banks that can be accessed in the same cycle", sim::power_of_two(1, 64),
          Affects::kTiming);
  }
};

/// Number of tiles of a frame on which a core works at the same time.
struct TilesInFlight {
  std::uint32_t first = 1;  ///< maximum tiles in flight per core in the first pass
  std::uint32_t later = 1;  ///< maximum tiles in flight per core in each later pass
  std::uint32_t max_tiles() const { return std::max(first, later); }
};

/// Returns the bytes that a full-size tile takes in the tile buffer: colours plus `attribute_bytes`.
inline std::uint64_t tile_bytes(const TileBufferConfig& config, const traces::FrameRequirements& needs,
                                std::uint32_t attribute_bytes) {
  return std::uint64_t{needs.tile_samples} * config.colour_bytes + attribute_bytes;
}

/// Returns the number of tiles on which a core works at the same time. In the first pass it is the configured number,
/// reduced (to at least one) so that ray slots get their share of the tile buffer. In later passes, it is the number
/// that fits into the space of the first pass's tiles. An ideal tile buffer is unlimited.
inline TilesInFlight tiles_in_flight(const TileBufferConfig& config, const traces::FrameRequirements& needs,
                                     bool ideal) {
  const std::uint64_t tile = tile_bytes(config, needs, needs.attribute_bytes);
  TilesInFlight tiles{config.tiles_in_flight, config.tiles_in_flight};
  if (!ideal && config.ray_share > 0 && tile != 0) {
    const auto room = static_cast<std::uint64_t>((1 - config.ray_share) * static_cast<double>(config.size.bytes));
    tiles.first = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(room / tile, 1, tiles.first));
  }
  tiles.later = tiles.first;
  if (needs.pass_attribute_bytes != 0) {
    const std::uint64_t later = tile_bytes(config, needs, needs.pass_attribute_bytes);
    const std::uint64_t fit = ideal ? config.tiles_in_pass : tiles.first * tile / later;
    tiles.later = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(fit, 1, config.tiles_in_pass));
  }
  return tiles;
}

/// A core's tile buffer: tracks the ray slots in use, and counts 16-byte accesses for the energy.
///
/// 1. A ray needs a free slot. The slot is also reserved for the ray's hit, so hits never wait.
/// 2. Bank conflicts of kernels are computed with their schedules (schedule.h).
///
/// Not modelled: bank conflicts with accesses of the T&I unit and the DMA.
class TileBuffer {
 public:
  static constexpr const char* kName = "core.tile_buffer";
  static constexpr Block kBlock = Block::kTileBuffer;
  enum class CycleReason : std::uint8_t { kIdle, kInUse, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "no tile is in flight on the core")},
      {CycleReason::kInUse, sim::background_reason("in_use", "tiles are in flight")},
  });
  struct Stats {
    std::uint64_t reads = 0, writes = 0, bank_conflicts = 0;
    std::uint64_t slots_taken = 0, slots_peak = 0, spilled_slots = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.reads), "16-byte reads", "tile.read");
      counter(NAMED(s.writes), "16-byte writes", "tile.write");
      counter(NAMED(s.bank_conflicts), "cycles in which a kernel stalled because of bank conflicts");
      counter(NAMED(s.slots_taken), "ray slots taken");
      counter(NAMED(s.slots_peak), "most ray slots in use at once", "", sim::CounterKind::kPeak);
      counter(NAMED(s.spilled_slots), "ray slots that did not fit and went through memory");
    }
  };

  /// Reserves space in the tile buffer for the colours and attributes of all tiles in flight. The rest of the buffer
  /// becomes ray slots.
  TileBuffer(const TileBufferConfig& config, const traces::FrameRequirements& needs, sim::Clock clock,
             bool ideal = false)
      : clock_(clock), slot_bytes_(config.slot_bytes) {
    const std::uint64_t set_aside =
        tiles_in_flight(config, needs, ideal).first * tile_bytes(config, needs, needs.attribute_bytes);
    slots_ = config.size.bytes > set_aside ? (config.size.bytes - set_aside) / config.slot_bytes : 0;
    if (ideal) slots_ = std::numeric_limits<std::uint64_t>::max();
  }

  std::uint64_t free_slots() const { return used_ < slots_ ? slots_ - used_ : 0; }
  std::uint64_t used_slots() const { return used_; }
  std::uint64_t slot_count() const { return slots_; }
  std::uint32_t slot_bytes() const { return slot_bytes_; }

  /// Allocates up to `count` free ray slots. Returns the number of requested slots that were not free.
  std::uint64_t allocate_slots(std::uint64_t count) {
    const std::uint64_t spilled = count - std::min(count, free_slots());
    used_ += count;
    stats_.slots_taken += count;
    stats_.slots_peak = std::max(stats_.slots_peak, used_);
    stats_.spilled_slots += spilled;
    return spilled;
  }
  void free_ray_slots(std::uint64_t count) { used_ -= count; }

  void count_reads(std::uint64_t accesses) { stats_.reads += accesses; }
  void count_writes(std::uint64_t accesses) { stats_.writes += accesses; }
  void count_conflicts(std::uint64_t cycles) { stats_.bank_conflicts += cycles; }

  /// Records whether the tile buffer is in use from time `now` on.
  void set_in_use(sim::Time now, bool is_used) {
    const CycleReason why = is_used ? CycleReason::kInUse : CycleReason::kIdle;
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
