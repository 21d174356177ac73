#pragma once
#include <array>
#include <cstdint>

#include "hw_models/dram/dram_config.h"

namespace hw {

/// Decides whether a row is closed with its last queued hit. The adaptive policy closes it if a request for another row
/// of the bank waits already. Else it goes by two bits for each bank that count how often, of late, the next request
/// wanted another row: it closes in the upper half of the count. Only that next request is evidence, whatever was
/// decided and whatever a refresh did in between.
class DramPagePolicy {
 public:
  explicit DramPagePolicy(PagePolicy policy) : policy_(policy) {}

  /// The last queued hit of the bank's row is being served: is the row closed with it? `others`: requests for other
  /// rows of the bank wait.
  bool closes(std::uint32_t bank, std::uint32_t row, bool others) {
    if (policy_ != PagePolicy::kAdaptive) return policy_ == PagePolicy::kClosed;
    if (others) {
      count(bank, true);
      return true;
    }
    last_row_[bank] = row;
    unproven_ |= 1U << bank;
    return others_[bank] >= 2;
  }

  /// A request for the bank arrives.
  void requested(std::uint32_t bank, std::uint32_t row) {
    if ((unproven_ >> bank & 1) == 0) return;
    unproven_ &= ~(1U << bank);
    count(bank, row != last_row_[bank]);
  }

 private:
  void count(std::uint32_t bank, bool other) {
    std::uint8_t& n = others_[bank];
    if (other ? n < 3 : n > 0) n = static_cast<std::uint8_t>(other ? n + 1 : n - 1);
  }

  PagePolicy policy_;
  std::uint32_t unproven_ = 0;  ///< banks whose next request is evidence, as a mask
  std::array<std::uint32_t, 32> last_row_{};
  std::array<std::uint8_t, 32> others_{};  ///< 0 to 3
};

}  // namespace hw
