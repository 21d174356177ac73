#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "hw_models/dram/bank_lanes.h"
#include "hw_models/dram/dram_config.h"
#include "hw_models/memory/messages.h"

namespace hw {

/// The read queue or write queue of a DRAM channel, oldest request first. For each bank, one bit mask marks the queue
/// positions of its requests, another those of its row hits. So the scheduler searches banks instead of requests.
class DramQueue {
 public:
  struct Entry {
    MemRequest request;
    DramAddress address;
    std::uint64_t arrived = 0;
    std::uint16_t port = 0;
    bool precharged = false;  ///< the DRAM channel precharged the bank for this request
    bool activated = false;   ///< the DRAM channel opened the row for this request
  };

  DramQueue(std::uint32_t capacity, std::uint32_t bank_count)
      : capacity_(capacity), waiting_(bank_count), hits_(bank_count) {
    assert(capacity <= 64);
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::uint8_t>(i);
  }

  bool empty() const { return size_ == 0; }
  bool is_full() const { return size_ == capacity_; }
  std::uint32_t size() const { return size_; }
  const Entry& oldest_entry() const { return entries_[order_[0]]; }
  Entry& at(std::uint32_t position) { return entries_[order_[position]]; }
  const Entry& at(std::uint32_t position) const { return entries_[order_[position]]; }

  /// Returns a mask of the DRAM banks with queued requests.
  std::uint32_t requested_bank_mask() const { return banks_; }
  /// Returns a mask of the DRAM banks with a queued row hit.
  std::uint32_t hit_bank_mask() const { return hit_banks_; }
  /// Returns a mask of the queue positions of all requests for DRAM bank `bank`.
  std::uint64_t request_position_mask(std::uint32_t bank) const { return waiting_[bank]; }
  /// Returns a mask of the queue positions of all requests that hit the open row of DRAM bank `bank`.
  std::uint64_t hit_position_mask(std::uint32_t bank) const { return hits_[bank]; }

  /// Returns a mask of the queue positions of all requests for the banks in the mask `bank_mask`.
  std::uint64_t request_position_mask_of_banks(std::uint32_t bank_mask) const {
    return waiting_.bitwise_or_of(bank_mask);
  }
  /// Returns a mask of the queue positions of all row hits of the banks in the mask `bank_mask`.
  std::uint64_t hit_position_mask_of_banks(std::uint32_t bank_mask) const { return hits_.bitwise_or_of(bank_mask); }

  void push(const Entry& entry, bool row_is_open) {
    assert(!is_full());
    const std::uint32_t bank = entry.address.bank;
    const std::uint64_t bit = std::uint64_t{1} << size_;
    entries_[order_[size_]] = entry;
    size_ += 1;
    waiting_[bank] |= bit;
    if (row_is_open) set_hit_positions(bank, hits_[bank] | bit);
    banks_ |= 1U << bank;
  }

  void remove_at(std::uint32_t position) {
    assert(position < size_);
    const std::uint8_t slot = order_[position];
    const std::uint32_t bank = entries_[slot].address.bank;
    std::copy(order_.data() + position + 1, order_.data() + size_, order_.data() + position);
    size_ -= 1;
    order_[size_] = slot;
    waiting_.transform_all([&](std::uint64_t positions) { return without_position(positions, position); });
    hits_.transform_all([&](std::uint64_t positions) { return without_position(positions, position); });
    set_hit_positions(bank, hits_[bank]);
    if (waiting_[bank] == 0) banks_ &= ~(1U << bank);
  }

  void note_row_opened(std::uint32_t bank, std::uint32_t row) {
    std::uint64_t hits = 0;
    for (std::uint64_t left = waiting_[bank]; left != 0; left &= left - 1) {
      const auto position = static_cast<std::size_t>(std::countr_zero(left));
      if (entries_[order_[position]].address.row == row) hits |= std::uint64_t{1} << position;
    }
    set_hit_positions(bank, hits);
  }
  void note_row_closed(std::uint32_t bank) { set_hit_positions(bank, 0); }

 private:
  void set_hit_positions(std::uint32_t bank, std::uint64_t position_mask) {
    hits_[bank] = position_mask;
    hit_banks_ = (hit_banks_ & ~(1U << bank)) | std::uint32_t{position_mask != 0} << bank;
  }

  /// Returns a mask of queue positions without one removed request. The bits of later requests move down by one.
  static std::uint64_t without_position(std::uint64_t position_mask, std::uint32_t position) {
    const std::uint64_t before = (std::uint64_t{1} << position) - 1;
    return (position_mask & before) | ((position_mask >> 1) & ~before);
  }

  std::uint32_t capacity_;
  std::uint32_t size_ = 0;
  std::uint32_t banks_ = 0;
  std::uint32_t hit_banks_ = 0;
  std::array<std::uint8_t, 64> order_{};
  std::array<Entry, 64> entries_{};
  BankLanes waiting_, hits_;
};

}  // namespace hw
