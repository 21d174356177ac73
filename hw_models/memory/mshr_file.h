#pragma once
#include <bit>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <vector>

#include "hw_models/memory/messages.h"
#include "sim/branch_free.h"

namespace hw {

/// Miss status holding registers (MSHRs, Kroft 1981) of a cache: its outstanding lines, each with a payload. Lines are
/// stored contiguously, so a search can compare several at once. A payload does not move while its line is outstanding.
template <class Payload>
class MshrFile {
 public:
  explicit MshrFile(std::uint32_t capacity)
      : capacity_(capacity),
        lines_((capacity + sim::kMatchWidth - 1) / sim::kMatchWidth * sim::kMatchWidth, kNone),
        payloads_(capacity + 1),
        slots_(capacity + 1) {
    std::iota(slots_.begin(), slots_.end(), 0U);
  }

  std::uint32_t size() const { return size_; }
  std::uint32_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  bool is_full() const { return size_ == capacity_; }

  /// Returns the MSHR payload of an outstanding line, or nullptr if the line is not outstanding.
  Payload* find_payload(Addr line) {
    const std::uint32_t i = index_of(line);
    return i == size_ ? nullptr : &payloads_[slots_[i]];
  }

  /// Allocates an MSHR for a line that is not outstanding. Returns its payload, which is not reset.
  Payload& allocate(Addr line) {
    assert(!is_full() && find_payload(line) == nullptr);
    lines_[size_] = line;
    return payloads_[slots_[size_++]];
  }

  /// Frees the MSHR of a line. Returns its payload, which stays valid until the next release.
  const Payload& release(Addr line) {
    const std::uint32_t i = index_of(line);
    assert(i < size_ && "a line came back without a request");
    const std::uint32_t freed = slots_[i];
    size_ -= 1;
    lines_[i] = lines_[size_];
    lines_[size_] = kNone;
    slots_[i] = slots_[size_];
    slots_[size_] = slots_.back();
    slots_.back() = freed;
    return payloads_[freed];
  }

 private:
  std::uint32_t index_of(Addr line) const {
    for (std::uint32_t first = 0; first < size_; first += sim::kMatchWidth) {
      const unsigned here = sim::match_mask8(&lines_[first], line);
      if (here != 0) return first + static_cast<std::uint32_t>(std::countr_zero(here));
    }
    return size_;
  }

  static constexpr Addr kNone = ~Addr{0};  ///< marks unused entries of `lines_`; no line has this address

  std::uint32_t capacity_;
  std::uint32_t size_ = 0;
  std::vector<Addr> lines_;  ///< addresses of the outstanding lines, followed by kNone in unused entries
  std::vector<Payload> payloads_;
  /// Index in `payloads_` of each line in `lines_`. The last entry is the payload that was released last.
  std::vector<std::uint32_t> slots_;
};

}  // namespace hw
