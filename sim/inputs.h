#pragma once
#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/link.h"

namespace sim {

/// The input links of one unit, at most 64. A mask shows which links contain items, so that empty ones are skipped.
template <class T>
class Inputs {
 public:
  explicit Inputs(std::vector<Link<T>*> links) : links_(std::move(links)), pop_at_(links_.size(), kNever) {
    assert(links_.size() <= 64);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      links_[i]->bind_occupancy_bit(&nonempty_mask_, static_cast<unsigned>(i));
      links_[i]->mirror_pop_time(&pop_at_[i]);
    }
  }
  Inputs(const Inputs&) = delete;
  Inputs& operator=(const Inputs&) = delete;

  std::size_t size() const { return links_.size(); }
  Link<T>& operator[](std::size_t i) const { return *links_[i]; }

  /// Returns a mask of the input links that contain items, including items that cannot be popped yet.
  std::uint64_t nonempty_mask() const { return nonempty_mask_; }
  /// Returns the earliest time at which an item can be popped from an input link: a local copy of Link::pop_at().
  Time pop_at(std::size_t link_index) const { return pop_at_[link_index]; }
  bool can_pop(std::size_t link_index, Time now) const { return pop_at_[link_index] <= now; }
  /// Returns the earliest time at which an item can be popped from any input link.
  Time pop_at() const {
    Time first = kNever;
    for (std::uint64_t left = nonempty_mask_; left != 0; left &= left - 1) {
      first = std::min(first, pop_at_[static_cast<std::size_t>(std::countr_zero(left))]);
    }
    return first;
  }
  /// Calls f(link) for each input link that contains items.
  template <class F>
  void for_each_nonempty(F&& f) const {
    for (std::uint64_t left = nonempty_mask_; left != 0; left &= left - 1) {
      f(*links_[static_cast<std::size_t>(std::countr_zero(left))]);
    }
  }

 private:
  std::vector<Link<T>*> links_;
  std::vector<Time> pop_at_;
  std::uint64_t nonempty_mask_ = 0;
};

}  // namespace sim
