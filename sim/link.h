#pragma once
#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/time.h"

namespace sim {

/// Handle through which a link lowers a unit's wake-up time, and the minimum of the unit's group in the WakeupTable.
struct WakeupHandle {
  WakeupHandle() = default;
  WakeupHandle(Time* wake) : unit(wake), group(wake) {}  ///< handle of a unit without a group; detached if null
  WakeupHandle(Time* wake, Time* earliest) : unit(wake), group(earliest) {}

  void lower_to(Time time) const {
    *unit = std::min(*unit, time);
    *group = std::min(*group, time);
  }

  Time* unit = nullptr;
  Time* group = nullptr;
};

/// A connection that carries items from one unit to another: a wire, a queue or a fixed-latency pipe.
///
///   producer --push--> [ `capacity` slots, visible `latency` later ] --pop--> consumer
///
/// 1. A slot has one timestamp: the earliest time at which the other end may access the slot.
/// 2. An action at time t is not visible at time t, so units may tick in any order.
/// 3. Links must not move in memory, because units hold references to them.
template <class T>
class Link {
 public:
  /// Creates a link within one clock domain. A pushed item can be popped `latency_cycles` (at least 1) cycles later.
  Link(std::size_t capacity, std::uint64_t latency_cycles, Clock clock)
      : Link(capacity, latency_cycles, clock, clock, 0) {}

  /// Creates a link between two clock domains. Its latency is `latency_cycles` cycles of the producer plus
  /// `synchroniser_cycles` cycles of the consumer, rounded up to the consumer's next clock edge.
  Link(std::size_t capacity, std::uint64_t latency_cycles, Clock producer, Clock consumer,
       std::uint64_t synchroniser_cycles)
      : slots_(capacity),
        capacity_(static_cast<std::uint32_t>(capacity)),
        crossing_(!(producer == consumer)),
        latency_(latency_cycles * producer.period() + (crossing_ ? synchroniser_cycles * consumer.period() : 0)),
        release_(consumer.period()),
        producer_clock_(producer),
        consumer_clock_(consumer) {
    assert(capacity > 0 && latency_cycles > 0);
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Sets the handles through which the link wakes its two units. The link wakes a unit for events that the unit cannot
  /// predict: the first item in an empty link, the first free slot in a full link. pop_at() and push_at() give all
  /// other times.
  void set_wakeup_handles(WakeupHandle producer, WakeupHandle consumer) {
    if (producer.unit != nullptr) producer_ = producer;
    if (consumer.unit != nullptr) consumer_ = consumer;
  }
  /// Makes the link keep bit number `bit` of `*mask` set while the link contains items (Inputs).
  void bind_occupancy_bit(std::uint64_t* mask, unsigned bit) {
    occupancy_mask_ = mask;
    bit_ = std::uint64_t{1} << bit;
    if (size_ != 0) *occupancy_mask_ |= bit_;
  }

  /// Makes the link keep `*pop_at` equal to its pop_at(). When an item enters the empty link, the link also lowers
  /// `*soonest` to the time from which that item can be popped.
  void store_pop_time_in(Time* pop_at, Time* soonest = nullptr) {
    *pop_at = *pop_at_;
    pop_at_ = pop_at;
    if (soonest == nullptr) return;
    *soonest = std::min(*soonest, *pop_at);
    soonest_ = soonest;
  }

  /// Makes the link increment `*count` while it has at most `free_slots` free slots (Partition).
  void count_if_nearly_full(std::uint32_t* count, std::size_t free_slots) {
    assert(size_ == 0);
    nearly_full_ = count;
    nearly_full_from_ = capacity_ - std::min(static_cast<std::uint32_t>(free_slots), capacity_);
    *nearly_full_ += nearly_full_from_ == 0;
  }
  /// Returns the time from a push until the item is visible, without rounding to the consumer's clock edge.
  Time latency() const { return latency_; }

  /// Returns the earliest known time at which an item can be pushed into the link; kNever while the link is full.
  Time push_at() const { return push_at_; }
  /// Returns the earliest known time at which an item can be popped from the link; kNever while the link is empty.
  Time pop_at() const { return *pop_at_; }
  bool can_push(Time now) const { return push_at() <= now; }
  bool can_pop(Time now) const { return pop_at() <= now; }

  void push(Time now, T item) {
    assert(can_push(now) && "push into a full link");
    Slot& slot = slots_[tail_];
    const Time stamp = crossing_ ? consumer_clock_.edge_at_or_after(now + latency_) : now + latency_;
    slot.item = std::move(item);
    slot.stamp = stamp;
    if (size_ == 0) {
      *pop_at_ = stamp;
      *soonest_ = std::min(*soonest_, stamp);
      *occupancy_mask_ |= bit_;
      consumer_.lower_to(stamp);
    }
    size_ += 1;
    *nearly_full_ += size_ == nearly_full_from_;
    tail_ = next_index(tail_);
    push_at_ = size_ == capacity_ ? kNever : slots_[tail_].stamp;
  }

  const T& front() const { return slots_[head_].item; }

  T pop(Time now) {
    assert(can_pop(now) && "pop from an empty link");
    Slot& slot = slots_[head_];
    const Time stamp = crossing_ ? producer_clock_.edge_at_or_after(now + release_) : now + release_;
    slot.stamp = stamp;
    if (size_ == capacity_) {
      push_at_ = stamp;
      producer_.lower_to(stamp);
    }
    *nearly_full_ -= size_ == nearly_full_from_;
    size_ -= 1;
    head_ = next_index(head_);
    if (size_ == 0) {
      *pop_at_ = kNever;
      *occupancy_mask_ &= ~bit_;
    } else {
      *pop_at_ = slots_[head_].stamp;
    }
    return std::move(slot.item);
  }

  /// True if the link contains no item, visible or not. For tests and state dumps only.
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }

 private:
  struct Slot {
    Time stamp = 0;
    T item{};
  };
  /// Returns the next index in the ring of slots. Branch-free, because the wrap of a short ring is unpredictable.
  std::uint32_t next_index(std::uint32_t i) const { return (i + 1) * std::uint32_t{i + 1 != capacity_}; }

  // Copies of the timestamps of the next pop and push, because units read them far more often than they pop or push.
  Time own_pop_at_ = kNever;
  Time* pop_at_ = &own_pop_at_;
  Time* soonest_ = &unused_time_;
  Time push_at_ = 0;
  std::vector<Slot> slots_;
  const std::uint32_t capacity_;
  std::uint32_t head_ = 0, tail_ = 0, size_ = 0;
  std::uint32_t nearly_full_from_ = 0;  ///< the link counts as nearly full from this number of items on
  const bool crossing_;
  const Time latency_,
      /// Latency from a push to the consumer, and from a pop to the producer, without rounding to the next clock edge.
      release_;
  WakeupHandle producer_{&unused_time_}, consumer_{&unused_time_};
  std::uint64_t* occupancy_mask_ = &unused_mask_;
  std::uint32_t* nearly_full_ = &unused_count_;
  std::uint64_t bit_ = 0;
  Time unused_time_ = kNever;  ///< target of writes while no wake-up handle is set
  std::uint64_t unused_mask_ = 0;
  std::uint32_t unused_count_ = 0;
  const Clock producer_clock_, consumer_clock_;
};

/// Returns the next time after `now` at which a unit may move an item from an input to an output. `item_at`: time at
/// which the item is available. `output_free_at`: time at which the output has room.
constexpr Time next_transfer_time(Time now, Time period, Time item_at, Time output_free_at) {
  return item_at > now ? item_at : std::max(now + period, output_free_at);
}

/// The input links of one unit, at most 64. A mask shows which links contain items, so that empty ones are skipped.
template <class T>
class Inputs {
 public:
  explicit Inputs(std::vector<Link<T>*> links) : links_(std::move(links)), pop_at_(links_.size(), kNever) {
    assert(links_.size() <= 64);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      links_[i]->bind_occupancy_bit(&nonempty_mask_, static_cast<unsigned>(i));
      links_[i]->store_pop_time_in(&pop_at_[i]);
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
