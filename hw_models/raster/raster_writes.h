#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "sim/link.h"
#include "sim/ring.h"

namespace hw {

/// Writes of a rasteriser to memory: bytes that follow each other in a line leave together.
class RasterWrites {
 public:
  RasterWrites(std::uint32_t lines, std::uint16_t port) : lines_(lines), port_(port) {}

  /// Room for so many lines besides the one that is being filled.
  bool has_room(std::uint32_t lines) const { return queue_.size() + lines <= lines_; }
  bool empty() const { return queue_.empty() && open_.sectors == 0; }
  /// A line or more waits for the way to memory.
  bool waiting() const { return !queue_.empty(); }
  /// Lines closed and sent so far.
  std::uint64_t closed() const { return sent_ + queue_.size(); }
  std::uint64_t sent() const { return sent_; }

  /// Adds bytes of one line for a tile. Needs room for a line.
  void add(Addr first, std::uint32_t bytes, Owner owner) {
    const Addr line = line_of(first);
    if (open_.sectors != 0 && open_.line != line) close();
    const Addr from = (first - line) / kSectorBytes, to = (first + bytes - 1 - line) / kSectorBytes;
    open_.line = line;
    open_.source = port_;
    open_.write = true;
    open_.owner = owner;
    open_.sectors = static_cast<SectorMask>(open_.sectors | ((2U << to) - (1U << from)));
  }
  /// Nothing more follows in the line that is being filled.
  void close() {
    if (open_.sectors == 0) return;
    queue_.push_back(open_);
    open_.sectors = 0;
  }
  /// Sends a line, if one waits and the link has room; true if so.
  bool send(sim::Time now, sim::Link<MemRequest>& out) {
    if (queue_.empty() || !out.can_push(now)) return false;
    out.push(now, queue_.front());
    queue_.pop_front();
    sent_ += 1;
    return true;
  }

 private:
  const std::uint32_t lines_;
  const std::uint16_t port_;
  MemRequest open_{.sectors = 0};
  sim::Ring<MemRequest> queue_;
  std::uint64_t sent_ = 0;
};

}  // namespace hw
