#pragma once
#include <bit>
#include <cassert>
#include <cstdint>

#include "hw_models/memory/messages.h"

namespace hw {

/// Interleaving of lines over `count` equal neighbours (L2 banks, DRAM channels): a field of address bits names the
/// owner.
class Interleave {
 public:
  constexpr Interleave(std::uint64_t granule_bytes, std::uint32_t count)
      : shift_(static_cast<std::uint32_t>(std::countr_zero(granule_bytes))), mask_(count - 1) {
    assert(std::has_single_bit(granule_bytes) && std::has_single_bit(count));
  }
  constexpr std::uint32_t owner(Addr line) const { return static_cast<std::uint32_t>(line >> shift_) & mask_; }

 private:
  std::uint32_t shift_;
  std::uint32_t mask_;
};

}  // namespace hw
