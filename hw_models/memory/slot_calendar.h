#pragma once
#include <cstdint>

namespace hw {

/// Which of the next 64 cycles of a bus are taken. A pattern is a bit mask of the cycles that something needs,
/// counted from its first: a command train books all its commands at once, and others may fit between them.
class SlotCalendar {
 public:
  using Cycle = std::uint64_t;

  bool free(Cycle at, std::uint64_t pattern) const { return (booked_from(at) & pattern) == 0; }

  /// The first cycle, `from` or later, at which the pattern meets nothing booked.
  Cycle first_free(Cycle from, std::uint64_t pattern) const {
    std::uint64_t booked = booked_from(from);
    while ((booked & pattern) != 0) {
      booked >>= 1;
      from += 1;
    }
    return from;
  }

  /// Books the pattern. Cycles before `at` are over and are forgotten.
  void book(Cycle at, std::uint64_t pattern) {
    booked_ = booked_from(at) | pattern;
    base_ = at;
  }

 private:
  std::uint64_t booked_from(Cycle at) const { return at - base_ >= 64 ? 0 : booked_ >> (at - base_); }

  Cycle base_ = 0;
  std::uint64_t booked_ = 0;
};

/// The pattern of `count` blocks of `length` cycles each, `stride` cycles apart.
constexpr std::uint64_t train(std::uint32_t count, std::uint32_t length, std::uint32_t stride) {
  std::uint64_t pattern = 0;
  for (std::uint32_t i = 0; i < count; ++i) pattern |= ((std::uint64_t{1} << length) - 1) << (i * stride);
  return pattern;
}

}  // namespace hw
