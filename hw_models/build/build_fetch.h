#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/build/tree_builder_config.h"
#include "hw_models/memory/cache.h"
#include "hw_models/memory/messages.h"
#include "sim/link.h"

namespace hw {

/// The cache lines that the builder reads for one triangle, instance or record, in two stages: the second stage's
/// addresses depend on what the first stage reads.
struct BuildLines {
  static constexpr std::uint32_t kStages = 2;
  static constexpr std::size_t kMost = 16;
  struct Stage {
    std::array<Addr, kMost> line{};
    std::uint32_t count = 0;
    /// Adds the lines of some bytes, each line once. Bytes beyond the last possible line are not fetched.
    void add_bytes(Addr first, std::uint64_t bytes) {
      if (bytes == 0) return;
      for (Addr at = line_of(first); at < first + bytes && count < kMost; at += kLineBytes) {
        if (std::find(line.begin(), line.begin() + count, at) == line.begin() + count) line[count++] = at;
      }
    }
  };
  std::array<Stage, kStages> stage{};
};

/// Fetches the lines of the builder's next items in order, before their use.
///
///   item --> [ stage 1: record, vertex numbers ] --> [ stage 2: vertices, node ] --> ready, oldest first
///
/// Each stage looks up its lines in the input buffer, item by item, without waiting. An item enters the second stage
/// when the lines of the first have arrived.
class BuildFetch {
 public:
  BuildFetch(const TreeBuilderConfig& config, std::uint16_t client, bool ideal)
      : buffer_(config.buffer, client, ideal), lookups_(config.lookups), slots_(config.window) {}

  bool has_room() const { return entered_ - left_ < slots_.size(); }
  bool empty() const { return entered_ == left_; }
  /// Adds an item to the builder's window. `tile`: entry of the tile list to which the requests are charged.
  void add_item(const BuildLines& lines, TileTag tile) {
    const auto slot = static_cast<std::uint32_t>(entered_++ % slots_.size());
    buffer_.set_slot_tile(slot, tile);
    slots_[slot] = {lines, 0, 0};
  }
  /// True if all lines of the oldest item in the builder's window have arrived.
  bool is_ready() const { return !empty() && done_[1] > left_ && slots_[left_ % slots_.size()].pending == 0; }
  void remove_oldest() { left_ += 1; }

  /// Looks up lines of the builder's window in the input buffer. Returns true if a stage has advanced. `count(hit)` is
  /// called for each look-up.
  template <class Count>
  bool look_up_lines(Count&& count) {
    std::uint32_t looked = 0;
    bool any = false;
    for (bool moved = true; moved && looked < lookups_;) {
      moved = advance_stage(1, looked, count) || advance_stage(0, looked, count);
      any |= moved;
    }
    return any;
  }
  void fill_line(Addr line) {
    for (std::uint64_t waiting = buffer_.fill_line(line).slots; waiting != 0; waiting &= waiting - 1) {
      slots_[static_cast<std::size_t>(std::countr_zero(waiting))].pending -= 1;
    }
  }
  void send_request(sim::Time now, sim::Link<MemRequest>& out) { buffer_.send_request(now, out); }
  sim::Time next_send_time(sim::Time next, const sim::Link<MemRequest>& out) const {
    return buffer_.next_send_time(next, out);
  }
  /// Empties the input buffer, because the next pass may read lines that this pass has written. Requires an empty
  /// window.
  void clear_buffer() { buffer_.clear(); }
  std::uint32_t outstanding_lines() const { return buffer_.outstanding_misses(); }
  std::uint64_t items_in_window() const { return entered_ - left_; }

 private:
  struct Slot {
    BuildLines lines;
    std::uint32_t next = 0;     ///< next line of the current stage to look up
    std::uint32_t pending = 0;  ///< requested lines that have not arrived
  };

  template <class Count>
  bool advance_stage(std::uint32_t stage, std::uint32_t& looked, Count&& count) {
    const std::uint64_t number = done_[stage];
    if (number == entered_ || (stage == 1 && done_[0] <= number)) return false;
    const auto slot_number = static_cast<std::uint32_t>(number % slots_.size());
    Slot& s = slots_[slot_number];
    if (stage == 1 && s.next == 0 && s.pending != 0) return false;
    const BuildLines::Stage& lines = s.lines.stage[stage];
    if (s.next < lines.count) {
      const L1Cache::Result result = buffer_.access_line(lines.line[s.next], slot_number);
      if (result == L1Cache::Result::kFull) return false;
      s.pending += result == L1Cache::Result::kMiss;
      count(result == L1Cache::Result::kHit);
      looked += 1;
      s.next += 1;
    }
    if (s.next == lines.count) {
      done_[stage] += 1;
      s.next = 0;
    }
    return true;
  }

  L1Cache buffer_;
  const std::uint32_t lookups_;
  std::vector<Slot> slots_;
  std::uint64_t entered_ = 0, left_ = 0;                   ///< items that have entered and left the window so far
  std::array<std::uint64_t, BuildLines::kStages> done_{};  ///< items that have passed each stage so far
};

}  // namespace hw
