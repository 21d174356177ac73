#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/memory/observer.h"

namespace tools {

/// An activity of a core with begin and end.
struct RecordedSlice {
  enum class Kind : std::uint8_t { kTile, kLoop, kRays, kTransfer };
  Kind kind = Kind::kTile;
  std::uint8_t what = 0;   ///< kRays: the kind of the rays; kTransfer: its area
  bool to_memory = false;  ///< kTransfer
  std::uint16_t core = 0;
  std::uint16_t slot = 0;                            ///< kTile: of the core
  std::uint16_t kernel = 0;                          ///< kLoop
  std::uint32_t entry = kNoEntry;                    ///< index in the tile list
  std::uint32_t amount = 0;                          ///< kLoop: items; kRays: rays; kTransfer: bytes
  std::uint32_t launches = 0;                        ///< kLoop: chunks of launches in it
  std::uint32_t rays_at_begin = 0, rays_at_end = 0;  ///< kRays: all of the core in its T&I unit
  sim::Time begin = 0, end = 0;
  sim::Time configured = 0, start = 0;  ///< kLoop: end of the configuration switch; begin of the loop
  std::uint64_t cycles = 0;             ///< kLoop: of the shader core
  sim::Time stalled = 0;                ///< kLoop
  static constexpr std::uint32_t kNoEntry = 0xffffffffU;
};

/// Work of the memory side in one bin of time.
struct MemoryBin {
  std::uint64_t l2_hits = 0, l2_misses = 0;
  std::uint64_t lines_read = 0, lines_written = 0;  ///< by memory, counted when their data end
};

/// Records a machine's activity in a frame for a timeline.
class TimelineRecorder final : public hw::Observer {
 public:
  static constexpr sim::Time kBin = 1'000'000'000;  ///< a microsecond

  explicit TimelineRecorder(std::uint32_t cores) : slots_(cores), batches_(cores) {}
  void on_event(const hw::Event& event) override;

  /// Returns the slices in the order in which they ended.
  const std::vector<RecordedSlice>& slices() const { return slices_; }
  const std::vector<MemoryBin>& memory_bins() const { return memory_; }

 private:
  void start_tile(const hw::TileStarted& event);
  void end_tile(const hw::TileEnded& event);
  void add_loop(const hw::LoopEnded& loop);
  void end_batch(const hw::BatchEnded& event);
  void add_transfer(const hw::TransferEnded& transfer);

  struct Slot {
    hw::TileTag owner = hw::kNoTile;
    std::uint32_t entry = RecordedSlice::kNoEntry;
    sim::Time begin = 0;
  };
  struct Batch {
    std::uint32_t slot = 0, node = 0;
    std::uint32_t rays = 0;  ///< in the T&I unit when it began
    sim::Time begin = 0;
  };
  MemoryBin& bin_at(sim::Time at) {
    const auto index = static_cast<std::size_t>(at / kBin);
    if (index >= memory_.size()) [[unlikely]]
      memory_.resize(index + 1);
    return memory_[index];
  }
  std::uint32_t entry_of(std::uint32_t core, hw::TileTag tile) const;

  std::uint32_t newest_ = 0;                 ///< highest entry of the tile list that a core has taken
  std::vector<std::vector<Slot>> slots_;     ///< by core
  std::vector<std::vector<Batch>> batches_;  ///< by core, in flight
  std::vector<RecordedSlice> slices_;
  std::vector<MemoryBin> memory_;
};

}  // namespace tools
