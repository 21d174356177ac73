#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

namespace sim {

/// A FIFO queue as a ring buffer, which allocates memory only when its length exceeds all earlier lengths.
template <class T>
class Ring {
 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const T& front() const { return slots_[head_]; }

  void push_back(T item) {
    if (size_ == slots_.size()) grow();
    slots_[wrap_index(head_ + size_)] = std::move(item);
    size_ += 1;
  }
  void pop_front() {
    assert(!empty());
    head_ = wrap_index(head_ + 1);
    size_ -= 1;
  }

 private:
  /// Wraps an index around the end of the ring buffer, whose size is a power of two.
  std::size_t wrap_index(std::size_t i) const { return i & (slots_.size() - 1); }
  void grow() {
    std::vector<T> longer(std::max<std::size_t>(64, 2 * slots_.size()));
    for (std::size_t i = 0; i < size_; ++i) longer[i] = std::move(slots_[wrap_index(head_ + i)]);
    slots_ = std::move(longer);
    head_ = 0;
  }

  std::vector<T> slots_;
  std::size_t head_ = 0, size_ = 0;
};

}  // namespace sim
