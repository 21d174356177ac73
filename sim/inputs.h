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

/// The links that lead into one unit, at most 64, and which of them hold something: a unit with many of them looks at
/// those alone.
template <class T>
class Inputs {
 public:
  explicit Inputs(std::vector<Link<T>*> links) : links_(std::move(links)) {
    assert(links_.size() <= 64);
    for (std::size_t i = 0; i < links_.size(); ++i) links_[i]->tell(&holding_, static_cast<unsigned>(i));
  }
  Inputs(const Inputs&) = delete;
  Inputs& operator=(const Inputs&) = delete;

  std::size_t size() const { return links_.size(); }
  Link<T>& operator[](std::size_t i) const { return *links_[i]; }

  /// A bit for each link that holds something, whether it may be popped already or not.
  std::uint64_t holding() const { return holding_; }
  /// When the first of all may be popped, as far as is known now.
  Time pop_at() const {
    Time first = kNever;
    each([&](const Link<T>& link) { first = std::min(first, link.pop_at()); });
    return first;
  }
  /// Calls f(link) for each that holds something.
  template <class F>
  void each(F&& f) const {
    for (std::uint64_t left = holding_; left != 0; left &= left - 1) {
      f(*links_[static_cast<std::size_t>(std::countr_zero(left))]);
    }
  }

 private:
  std::vector<Link<T>*> links_;
  std::uint64_t holding_ = 0;
};

}  // namespace sim
