#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hw {

/// Vertices lately transformed, by number; the oldest goes, whether it has been used again or not.
class VertexCache {
 public:
  explicit VertexCache(std::uint32_t entries) : entries_(entries, kNothing) {}

  /// True if the vertex is here; otherwise it is from now on.
  bool use(std::uint32_t vertex) {
    if (std::ranges::find(entries_, std::uint64_t{vertex}) != entries_.end()) return true;
    entries_[next_] = vertex;
    next_ = next_ + 1 == entries_.size() ? 0 : next_ + 1;
    return false;
  }

 private:
  static constexpr std::uint64_t kNothing = ~std::uint64_t{0};
  std::vector<std::uint64_t> entries_;
  std::size_t next_ = 0;
};

}  // namespace hw
