#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/report/unit_report.h"

namespace tools {

/// A counter, summed over the units of an energy block.
std::uint64_t sum_of(std::span<const sim::UnitReport> units, std::string_view block, std::string_view counter);

/// Those of a machine's units whose path begins with `prefix` and has `kind` in it, and sums over them.
class Units {
 public:
  Units(std::span<const sim::UnitReport> units, std::string_view prefix, std::string_view kind = {});

  bool empty() const { return units_.empty(); }
  double elapsed() const;
  /// Cycles given to a reason, all units together.
  double spent(std::string_view reason) const;
  double counted(std::string_view counter) const;
  /// Of all their time, that given to a reason; 0 without any.
  double share(std::string_view reason) const { return elapsed() == 0 ? 0 : spent(reason) / elapsed(); }
  double clock_mhz() const { return units_.empty() ? 1 : units_.front()->clock_mhz; }

 private:
  std::vector<const sim::UnitReport*> units_;
};

}  // namespace tools
