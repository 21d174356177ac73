#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/time.h"
#include "traces/stream.h"

namespace hw {

/// Configuration memory of a shader core's array: tracks which kernels' configurations are in it. The least recently
/// used ones are evicted to make room for another. A configuration need not be contiguous, so there is no
/// fragmentation.
class ConfigMemory {
 public:
  ConfigMemory(std::uint64_t bytes, std::size_t max_kernels) : free_(bytes) { resident_.reserve(max_kernels); }

  /// Selects the kernel that runs next. Returns true if its configuration, of `config_bytes` bytes, is in configuration
  /// memory. Otherwise loads it, and keeps it there if it fits.
  bool select_kernel(traces::KernelId kernel, std::uint64_t config_bytes) {
    const auto found = std::ranges::find(resident_, kernel, &Resident::kernel);
    if (found != resident_.end()) {
      std::rotate(found, found + 1, resident_.end());
      return true;
    }
    std::size_t leave = 0;
    for (; free_ < config_bytes && leave < resident_.size(); ++leave) free_ += resident_[leave].bytes;
    resident_.erase(resident_.begin(), resident_.begin() + static_cast<std::ptrdiff_t>(leave));
    if (config_bytes > free_) return false;
    free_ -= config_bytes;
    resident_.push_back({kernel, config_bytes});
    return false;
  }

 private:
  struct Resident {
    traces::KernelId kernel = 0;
    std::uint64_t bytes = 0;
  };
  std::uint64_t free_;
  std::vector<Resident> resident_;  ///< kernels in configuration memory, least recently used first
};

/// A chunk: consecutive items of one kernel launch that run in a loop on the shader core's array.
struct LoopChunk {
  std::uint32_t tile = 0, node = 0;
  std::uint32_t first = 0, items = 0;  ///< first item within the launch; number of items, idle ones included
  std::uint32_t working = 0;           ///< number of the chunk's leading items that do not idle
  std::uint32_t begin = 0;             ///< index of the chunk's first item within the loop
};

/// The chunks of kernel launches that run as one loop on the shader core's array. The loop first runs all items
/// that are not idle, then the idle items of all chunks.
class LoopChunks {
 public:
  void reserve(std::size_t chunks) { chunks_.reserve(chunks); }
  void clear() {
    chunks_.clear();
    items_ = working_ = 0;
  }
  void add(LoopChunk chunk) {
    chunk.begin = working_;
    items_ += chunk.items;
    working_ += chunk.working;
    chunks_.push_back(chunk);
  }

  std::uint32_t item_count() const { return items_; }
  std::uint32_t non_idle_count() const { return working_; }
  std::size_t size() const { return chunks_.size(); }
  auto begin() const { return chunks_.begin(); }
  auto end() const { return chunks_.end(); }
  /// Returns the chunk of a launch in this loop, or null if no chunk of the launch is in the loop.
  const LoopChunk* find_chunk_of_launch(std::uint32_t tile, std::uint32_t node) const {
    const auto part =
        std::ranges::find_if(chunks_, [&](const LoopChunk& p) { return p.tile == tile && p.node == node; });
    return part == chunks_.end() ? nullptr : &*part;
  }
  /// Returns the chunk of the array loop to which an item, which must not be idle, belongs.
  const LoopChunk& chunk_of(std::uint32_t item) const {
    return *std::ranges::find_if(chunks_, [&](const LoopChunk& p) { return item < p.begin + p.working; });
  }

 private:
  std::vector<LoopChunk> chunks_;
  std::uint32_t items_ = 0, working_ = 0;
};

/// The software-pipelined loop that a shader core's array runs. Array time is the time since the start of the loop,
/// minus its stall time.
struct ArrayLoop {
  bool active = false;
  traces::KernelId kernel = 0;
  LoopChunks chunks;
  std::uint32_t loading = 0;              ///< number of the loop's leading items that access the data cache
  sim::Time begin = 0;                    ///< time at which the switch to the loop's kernel starts
  sim::Time without_rays = 0;             ///< value of RayFeeder::time_without_rays() at time `begin`
  sim::Time configured = 0;               ///< time at which the switch to the loop's kernel ends
  sim::Time start = 0;                    ///< time at which the loop's first item starts
  sim::Time stall_time = 0;               ///< stall time of the loop so far
  sim::Time stalled_since = sim::kNever;  ///< time at which the current stall began; kNever: the loop is not stalled
  std::uint32_t next_item = 0;            ///< next loop item whose cache lines will be requested
  std::uint32_t next_line = 0;            ///< index of the next cache line of item `next_item` to request
  std::uint32_t ii = 1, depth = 0;

  bool is_stalled() const { return stalled_since != sim::kNever; }
  void begin_stall(sim::Time now) { stalled_since = now; }
  void end_stall(sim::Time now) {
    stall_time += now - stalled_since;
    stalled_since = sim::kNever;
  }
  sim::Time array_time(sim::Time now) const { return (is_stalled() ? stalled_since : now) - start - stall_time; }
  /// Returns the time at which a loop item leaves the array if there are no further stalls.
  sim::Time item_end(const sim::Clock& clock, std::uint32_t item) const {
    return start + stall_time + (depth + sim::Time{item} * ii) * clock.period();
  }
};

}  // namespace hw
