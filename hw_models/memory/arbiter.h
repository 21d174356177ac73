#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/time.h"

namespace hw {

/// Who goes first where several want the same way.
enum class Arbitration : std::uint8_t {
  kRoundRobin,   ///< each in turn
  kOldestFirst,  ///< who has been there longest, of equals the first
  kFixed,        ///< the first that can; the last may wait as long as the others have work
};
constexpr std::array<std::string_view, 3> names_of(Arbitration) { return {"round_robin", "oldest_first", "fixed"}; }

/// Chooses among `count` askers.
class Arbiter {
 public:
  Arbiter(Arbitration how, std::size_t count) : how_(how), count_(static_cast<std::uint32_t>(count)) {}

  std::uint32_t count() const { return count_; }

  /// One of those for whom `ready(i)`; they have been there since `since(i)`. count() if there is none.
  template <class Ready, class Since>
  std::uint32_t choose(Ready&& ready, Since&& since) const {
    if (how_ == Arbitration::kOldestFirst) return oldest(ready, since);
    for (std::uint32_t i = 0, at = turn_; i < count_; ++i, at = after(at)) {
      if (ready(at)) return at;
    }
    return count_;
  }
  /// It was the asker's turn.
  void served(std::uint32_t asker) {
    if (how_ == Arbitration::kRoundRobin) turn_ = after(asker);
  }

 private:
  std::uint32_t after(std::uint32_t i) const { return i + 1 == count_ ? 0 : i + 1; }
  template <class Ready, class Since>
  std::uint32_t oldest(Ready&& ready, Since&& since) const {
    std::uint32_t found = count_;
    sim::Time first = sim::kNever;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (since(i) >= first || !ready(i)) continue;
      found = i;
      first = since(i);
    }
    return found;
  }

  Arbitration how_;
  std::uint32_t count_;
  std::uint32_t turn_ = 0;
};

}  // namespace hw
