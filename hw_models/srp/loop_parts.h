#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace hw {

/// Chunk of a launch in the loop on the array.
struct LoopPart {
  std::uint32_t tile = 0, node = 0;
  std::uint32_t first = 0, items = 0;  ///< items of the launch, idle ones included
  std::uint32_t working = 0;           ///< leading ones of these that do not idle
  std::uint32_t begin = 0;             ///< the loop's item that the first one is
};

/// Chunks that run together in one loop: their working items behind each other, then all that idle.
class LoopParts {
 public:
  void reserve(std::size_t parts) { parts_.reserve(parts); }
  void clear() {
    parts_.clear();
    items_ = working_ = 0;
  }
  void add(LoopPart part) {
    part.begin = working_;
    items_ += part.items;
    working_ += part.working;
    parts_.push_back(part);
  }

  std::uint32_t items() const { return items_; }
  std::uint32_t working() const { return working_; }
  std::size_t size() const { return parts_.size(); }
  auto begin() const { return parts_.begin(); }
  auto end() const { return parts_.end(); }
  /// The part of a launch, or null.
  const LoopPart* find(std::uint32_t tile, std::uint32_t node) const {
    const auto part = std::ranges::find_if(parts_, [&](const LoopPart& p) { return p.tile == tile && p.node == node; });
    return part == parts_.end() ? nullptr : &*part;
  }
  /// The part that a working item of the loop belongs to.
  const LoopPart& of(std::uint32_t item) const {
    return *std::ranges::find_if(parts_, [&](const LoopPart& p) { return item < p.begin + p.working; });
  }

 private:
  std::vector<LoopPart> parts_;
  std::uint32_t items_ = 0, working_ = 0;
};

}  // namespace hw
