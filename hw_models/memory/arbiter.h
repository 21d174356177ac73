#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/time.h"

namespace hw {

/// Order in which an arbiter serves several requesters of one resource.
enum class Arbitration : std::uint8_t {
  kRoundRobin,   ///< round robin: each requester is served in turn
  kOldestFirst,  ///< the requester that has waited longest is served, the lowest number among equals
  kFixed,        ///< the ready requester with the lowest number is served, so others can starve
};
constexpr std::array<std::string_view, 3> names_of(Arbitration) { return {"round_robin", "oldest_first", "fixed"}; }

/// Decides which of up to 64 requesters of a shared resource is served next.
class Arbiter {
 public:
  Arbiter(Arbitration arbitration, std::size_t count)
      : arbitration_(arbitration), count_(static_cast<std::uint32_t>(count)) {
    assert(count <= 64);
  }

  std::uint32_t requester_count() const { return count_; }

  /// Returns the requester to serve next, among those of the mask `requester_mask` that are ready; requester_count() if
  /// there is none. is_ready(i): requester i can be served. waiting_since(i): time since which it waits.
  template <class Ready, class Since>
  std::uint32_t choose_requester(std::uint64_t requester_mask, Ready&& is_ready, Since&& waiting_since) const {
    if (arbitration_ == Arbitration::kOldestFirst) return oldest_ready(requester_mask, is_ready, waiting_since);
    for (std::uint64_t left = std::rotr(requester_mask, static_cast<int>(turn_)); left != 0; left &= left - 1) {
      const std::uint32_t i = (static_cast<std::uint32_t>(std::countr_zero(left)) + turn_) % 64;
      if (is_ready(i)) return i;
    }
    return count_;
  }
  /// Updates the round-robin order of the arbiter after `requester` has been served.
  void note_served(std::uint32_t requester) {
    if (arbitration_ == Arbitration::kRoundRobin) turn_ = next_index(requester);
  }

 private:
  std::uint32_t next_index(std::uint32_t i) const { return i + 1 == count_ ? 0 : i + 1; }
  template <class Ready, class Since>
  std::uint32_t oldest_ready(std::uint64_t requester_mask, Ready&& is_ready, Since&& waiting_since) const {
    std::uint32_t found = count_;
    sim::Time first = sim::kNever;
    for (std::uint64_t left = requester_mask; left != 0; left &= left - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
      if (waiting_since(i) >= first || !is_ready(i)) continue;
      found = i;
      first = waiting_since(i);
    }
    return found;
  }

  Arbitration arbitration_;
  std::uint32_t count_;
  std::uint32_t turn_ = 0;
};

}  // namespace hw
