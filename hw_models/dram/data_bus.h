#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hw {

/// The bursts that are booked on a DRAM data bus and not over yet, in the order of time.
class DataBus {
 public:
  using Cycle = std::uint64_t;
  struct Burst {
    Cycle begin = 0, end = 0;
    bool write = false;
  };

  explicit DataBus(std::size_t capacity) : bursts_(capacity), capacity_(capacity) {}

  bool empty() const { return size_ == 0; }
  const Burst& front() const { return bursts_[head_]; }
  void pop() {
    head_ = next(head_);
    size_ -= 1;
  }

  /// Bursts of two bank groups may interleave, so a new one may begin before the last one booked.
  void book(Burst burst) {
    assert(size_ < capacity_);
    std::size_t i = head_ + size_ < capacity_ ? head_ + size_ : head_ + size_ - capacity_;
    size_ += 1;
    for (std::size_t left = size_ - 1; left > 0; --left) {
      const std::size_t before = i == 0 ? capacity_ - 1 : i - 1;
      if (bursts_[before].begin <= burst.begin) break;
      bursts_[i] = bursts_[before];
      i = before;
    }
    bursts_[i] = burst;
  }

 private:
  std::size_t next(std::size_t i) const { return i + 1 == capacity_ ? 0 : i + 1; }

  std::vector<Burst> bursts_;
  std::size_t capacity_;
  std::size_t head_ = 0;
  std::size_t size_ = 0;
};

}  // namespace hw
