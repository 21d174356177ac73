#pragma once
#include <bit>
#include <cstdint>

#include "hw_models/dram/dram_config.h"
#include "hw_models/memory/messages.h"

namespace hw {

/// A line's address inside its channel; its column plays no part in timing.
struct DramAddress {
  std::uint32_t bank = 0;  ///< among the banks of all ranks, rank by rank
  std::uint32_t row = 0;
};

/// Address bits to rank, bank and row; the channel is chosen before, by DramConfig::interleave().
class DramMap {
 public:
  explicit DramMap(const DramConfig& c)
      : bank_first_(c.controller.mapping == DramMapping::kRowColumnBankChannel),
        skip_(shift_of(c.line.bytes) + shift_of(c.channels)),
        column_bits_(shift_of(c.organisation.page.bytes) - shift_of(c.line.bytes)),
        bank_bits_(shift_of(c.organisation.all_banks())),
        xor_mask_(c.controller.bank_xor ? c.organisation.banks - 1 : 0),
        row_mask_(c.organisation.rows - 1) {}

  DramAddress address(Addr line) const {
    // Whatever the order of channel and column, both lie below bank and row, so one shift serves both mappings.
    const Addr in_channel = line >> skip_;
    const std::uint32_t bank_mask = (1U << bank_bits_) - 1;
    DramAddress a;
    a.bank = static_cast<std::uint32_t>(in_channel >> (bank_first_ ? 0 : column_bits_)) & bank_mask;
    a.row = static_cast<std::uint32_t>(in_channel >> (column_bits_ + bank_bits_)) & row_mask_;
    a.bank ^= a.row & xor_mask_;
    return a;
  }

 private:
  static constexpr std::uint32_t shift_of(std::uint64_t n) { return static_cast<std::uint32_t>(std::countr_zero(n)); }

  bool bank_first_;
  std::uint32_t skip_;
  std::uint32_t column_bits_;
  std::uint32_t bank_bits_;  ///< those of the rank included, above
  std::uint32_t xor_mask_;
  std::uint32_t row_mask_;
};

}  // namespace hw
