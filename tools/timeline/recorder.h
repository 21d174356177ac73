#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/machines/watchers.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/observer.h"

namespace tools {

/// Something that took a core a while.
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
  sim::Time configured = 0, start = 0;  ///< kLoop: the switch is over, the loop begins
  std::uint64_t cycles = 0;             ///< kLoop: of the shader core
  sim::Time stalled = 0;                ///< kLoop
  static constexpr std::uint32_t kNoEntry = 0xffffffffU;
};

/// Work of the memory side in a stretch of time.
struct MemoryBin {
  std::uint64_t l2_hits = 0, l2_misses = 0;
  std::uint64_t lines_read = 0, lines_written = 0;  ///< by memory: whose data end in it
};

/// Keeps what a machine does in a frame, to be shown as a timeline.
class TimelineRecorder final : public hw::Observer, public hw::L2Bank::Watcher, public hw::DramChannel::Watcher {
 public:
  static constexpr sim::Time kBin = 1'000'000'000;  ///< a microsecond

  explicit TimelineRecorder(std::uint32_t cores) : slots_(cores), batches_(cores) {}
  hw::Watchers watchers() { return {.cores = this, .l2 = this, .dram = this}; }

  /// In the order in which they ended.
  const std::vector<RecordedSlice>& slices() const { return slices_; }
  const std::vector<MemoryBin>& memory() const { return memory_; }

  void tile_begins(std::uint32_t core, std::uint32_t slot, hw::Owner tile, sim::Time now) override;
  void tile_ends(std::uint32_t core, std::uint32_t slot, sim::Time now) override;
  void loop_ends(std::uint32_t core, const hw::ObservedLoop& loop) override;
  void batch_begins(std::uint32_t core, std::uint32_t slot, std::uint32_t node, std::uint64_t rays,
                    sim::Time now) override;
  void batch_ends(std::uint32_t core, std::uint32_t slot, std::uint32_t node, const traces::WorkNode& batch,
                  std::uint64_t rays, sim::Time now) override;
  void transfer_ends(std::uint32_t core, const hw::DmaJob& job, sim::Time begin, sim::Time end) override;
  void looked_up(bool hit, sim::Time now) override { (hit ? bin(now).l2_hits : bin(now).l2_misses) += 1; }
  void served(const hw::MemRequest& request, sim::Time end) override {
    (request.write ? bin(end).lines_written : bin(end).lines_read) += 1;
  }

 private:
  struct Slot {
    hw::Owner owner = hw::kNoOwner;
    std::uint32_t entry = RecordedSlice::kNoEntry;
    sim::Time begin = 0;
  };
  struct Batch {
    std::uint32_t slot = 0, node = 0;
    std::uint32_t rays = 0;  ///< in the T&I unit when it began
    sim::Time begin = 0;
  };
  MemoryBin& bin(sim::Time at) {
    const auto index = static_cast<std::size_t>(at / kBin);
    if (index >= memory_.size()) [[unlikely]]
      memory_.resize(index + 1);
    return memory_[index];
  }
  std::uint32_t entry_of(std::uint32_t core, hw::Owner tile) const;

  std::uint32_t newest_ = 0;                 ///< entry of the tile list that a core has taken
  std::vector<std::vector<Slot>> slots_;     ///< by core
  std::vector<std::vector<Batch>> batches_;  ///< by core: under way
  std::vector<RecordedSlice> slices_;
  std::vector<MemoryBin> memory_;
};

}  // namespace tools
