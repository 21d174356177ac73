#include "sim/report/unit_report.h"

#include <cassert>
#include <cstddef>

namespace sim {

void add_reports(std::vector<UnitReport>& sum, const std::vector<UnitReport>& more) {
  assert(sum.size() == more.size());
  for (std::size_t u = 0; u < sum.size(); ++u) {
    sum[u].elapsed += more[u].elapsed;
    for (std::size_t i = 0; i < sum[u].why.size(); ++i) sum[u].why[i].second += more[u].why[i].second;
    for (std::size_t i = 0; i < sum[u].counters.size(); ++i) sum[u].counters[i].value += more[u].counters[i].value;
  }
}

}  // namespace sim
