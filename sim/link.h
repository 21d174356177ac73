#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/time.h"
#include "sim/wakes.h"

namespace sim {

/// Connection that carries items from one unit to another: a wire, a queue or a fixed-latency pipe.
///
///   producer --push--> [ `capacity` slots, visible `latency` later ] --pop--> consumer
///
/// A slot carries one stamp: the first time at which its other end may touch it. Nothing done at time t is visible
/// at time t, so units may tick in any order, and every stamp is a wake-up time known for free.
/// Links are pinned: units hold references to them.
template <class T>
class Link {
 public:
  /// One clock domain: an item pushed at t can be popped `latency_cycles` (at least 1) later.
  Link(std::size_t capacity, std::uint64_t latency_cycles, Clock clock)
      : Link(capacity, latency_cycles, clock, clock, 0) {}

  /// Two domains: the latency counts in the producer's cycles, then `synchroniser_cycles` of the consumer's clock,
  /// and the sum is rounded up to the consumer's edge.
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

  /// Wake-up times of its ends, which this link lowers when it gives an end something to do that the end cannot
  /// know of: the first item in an empty link, the first room in a full one. All else it says by pop_at() and
  /// push_at().
  void wakes(Waker producer, Waker consumer) {
    if (producer.unit != nullptr) producer_ = producer;
    if (consumer.unit != nullptr) consumer_ = consumer;
  }
  /// Keeps `bit` of the set while something is inside (sim/inputs.h).
  void tell(std::uint64_t* set, unsigned bit) {
    holding_ = set;
    bit_ = std::uint64_t{1} << bit;
    if (size_ != 0) *holding_ |= bit_;
  }

  /// Keeps pop_at() there, beside what else its consumer looks at, and lowers `soonest` to it for the first item in an
  /// empty link.
  void shows(Time* pop_at, Time* soonest = nullptr) {
    *pop_at = *pop_at_;
    pop_at_ = pop_at;
    if (soonest == nullptr) return;
    *soonest = std::min(*soonest, *pop_at);
    soonest_ = soonest;
  }

  /// Counts itself there while there is room for so many items at most (sim/partitions.h).
  void count_if_nearly_full(std::uint32_t* count, std::size_t room) {
    assert(size_ == 0);
    nearly_full_ = count;
    nearly_full_from_ = capacity_ - std::min(static_cast<std::uint32_t>(room), capacity_);
    *nearly_full_ += nearly_full_from_ == 0;
  }
  /// Time from a push to the first moment at which the item can be seen.
  Time latency() const { return latency_; }

  /// When the producer may push next as far as is known now; kNever while the slot waits for a pop.
  Time push_at() const { return push_at_; }
  /// When the consumer may pop next as far as is known now; kNever while there is nothing.
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
      *holding_ |= bit_;
      consumer_.lower(stamp);
    }
    size_ += 1;
    *nearly_full_ += size_ == nearly_full_from_;
    tail_ = after(tail_);
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
      producer_.lower(stamp);
    }
    *nearly_full_ -= size_ == nearly_full_from_;
    size_ -= 1;
    head_ = after(head_);
    if (size_ == 0) {
      *pop_at_ = kNever;
      *holding_ &= ~bit_;
    } else {
      *pop_at_ = slots_[head_].stamp;
    }
    return std::move(slot.item);
  }

  /// Nothing inside, seen from outside time (tests, state dumps).
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }

 private:
  struct Slot {
    Time stamp = 0;
    T item{};
  };
  /// The next slot, found without a branch: where a short ring ends no host foresees.
  std::uint32_t after(std::uint32_t i) const { return (i + 1) * std::uint32_t{i + 1 != capacity_}; }

  // The stamps at both ends, kept apart because units look at them far more often than they push or pop.
  Time own_pop_at_ = kNever;
  Time* pop_at_ = &own_pop_at_;
  Time* soonest_ = &nobody_;
  Time push_at_ = 0;
  std::vector<Slot> slots_;
  const std::uint32_t capacity_;
  std::uint32_t head_ = 0, tail_ = 0, size_ = 0;
  std::uint32_t nearly_full_from_ = 0;  ///< items
  const bool crossing_;
  const Time latency_, release_;  ///< from a push to the consumer, from a pop to the producer, but for the next edge
  Waker producer_{&nobody_}, consumer_{&nobody_};
  std::uint64_t* holding_ = &nobodys_;
  std::uint32_t* nearly_full_ = &nobodys_count_;
  std::uint64_t bit_ = 0;
  Time nobody_ = kNever;  ///< woken where there is no engine
  std::uint64_t nobodys_ = 0;
  std::uint32_t nobodys_count_ = 0;
  const Clock producer_clock_, consumer_clock_;
};

/// The next time after `now` at which an item-and-room pair changes.
constexpr Time opens(Time now, Time period, Time item_at, Time room_at) {
  return item_at > now ? item_at : std::max(now + period, room_at);
}

}  // namespace sim
