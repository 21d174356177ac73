#include "sim/unit_report.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace sim {

void add_reports(std::vector<UnitReport>& sum, const std::vector<UnitReport>& more) {
  assert(sum.size() == more.size());
  for (std::size_t u = 0; u < sum.size(); ++u) {
    sum[u].elapsed += more[u].elapsed;
    for (std::size_t i = 0; i < sum[u].cycles_by_reason.size(); ++i)
      sum[u].cycles_by_reason[i].second += more[u].cycles_by_reason[i].second;
    for (std::size_t i = 0; i < sum[u].counters.size(); ++i) {
      std::uint64_t& value = sum[u].counters[i].value;
      const CounterReport& other = more[u].counters[i];
      value = other.kind == CounterKind::kPeak ? std::max(value, other.value) : value + other.value;
    }
  }
}

void subtract_reports(std::vector<UnitReport>& later, const std::vector<UnitReport>& earlier) {
  assert(later.size() == earlier.size());
  for (std::size_t u = 0; u < later.size(); ++u) {
    later[u].elapsed -= earlier[u].elapsed;
    for (std::size_t i = 0; i < later[u].cycles_by_reason.size(); ++i)
      later[u].cycles_by_reason[i].second -= earlier[u].cycles_by_reason[i].second;
    for (std::size_t i = 0; i < later[u].counters.size(); ++i) {
      CounterReport& counter = later[u].counters[i];
      if (counter.kind != CounterKind::kPeak) counter.value -= earlier[u].counters[i].value;
    }
  }
}

}  // namespace sim
