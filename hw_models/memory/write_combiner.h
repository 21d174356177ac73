#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "sim/link.h"
#include "sim/ring.h"

namespace hw {

/// Write queue of a unit. Consecutive bytes of one cache line are combined into one write.
class WriteCombiner {
 public:
  WriteCombiner(std::uint32_t lines, std::uint16_t client) : lines_(lines), client_(client) {}

  /// True if the queue has room for `lines` more lines, in addition to the line being collected.
  bool has_room(std::uint32_t lines) const { return queue_.size() + lines <= lines_; }
  bool empty() const { return queue_.empty() && open_.sectors == 0; }
  /// True if a closed line waits to be sent to memory.
  bool has_closed_line() const { return !queue_.empty(); }
  /// Returns the number of lines that the queue has closed so far, including unsent ones.
  std::uint64_t closed_lines() const { return sent_ + queue_.size(); }
  std::uint64_t sent_lines() const { return sent_; }

  /// Writes bytes of one cache line on behalf of a tile. Requires room for one line in the write queue.
  void add_bytes(Addr first_byte, std::uint32_t bytes, TileTag tile) {
    const Addr line = line_of(first_byte);
    if (open_.sectors != 0 && open_.line != line) close_line();
    const Addr from = (first_byte - line) / kSectorBytes, to = (first_byte + bytes - 1 - line) / kSectorBytes;
    open_.line = line;
    open_.source = client_;
    open_.write = true;
    open_.tile = tile;
    open_.sectors = static_cast<SectorMask>(open_.sectors | ((2U << to) - (1U << from)));
  }
  /// Closes the cache line that is being collected, so that it is sent although it is not full.
  void close_line() {
    if (open_.sectors == 0) return;
    queue_.push_back(open_);
    open_.sectors = 0;
  }
  /// Sends a closed line to memory. Returns false if there is none or the link has no room.
  bool send_line(sim::Time now, sim::Link<MemRequest>& out) {
    if (queue_.empty() || !out.can_push(now)) return false;
    out.push(now, queue_.front());
    queue_.pop_front();
    sent_ += 1;
    return true;
  }

 private:
  const std::uint32_t lines_;
  const std::uint16_t client_;
  MemRequest open_{.sectors = 0};
  sim::Ring<MemRequest> queue_;
  std::uint64_t sent_ = 0;
};

}  // namespace hw
