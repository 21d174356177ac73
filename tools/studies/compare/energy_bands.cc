#include "sim/error.h"
#include "tools/studies/compare/compare.h"

namespace tools {

void compare_energy(const ReportFile& a, const ReportFile& b, Comparison& out) {
  try {
    PricedRun of_a(a), of_b(b);
    out.energy = {energy_ratio(of_a, of_b, ""), energy_ratio(of_a, of_b, "tni"), tornado(of_a, of_b, "")};
  } catch (const sim::InputError& error) {
    out.no_energy = error.what();
  }
}

}  // namespace tools
