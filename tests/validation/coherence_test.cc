#include <map>
#include <string>

#include <gtest/gtest.h>

#include "tests/validation/figures.h"
#include "tools/studies/reproduce/plan.h"

// Compares mechanisms against incoherent rays with publications. DEVIATIONS.md explains deviations (K1 and K2).

namespace tools::reproduce {
namespace {

/// Returns the metrics of a setting of `raywatt reproduce coherence` on the built-in scene `chess`, on `rt-warp-like`.
std::map<std::string, double> coherence_metrics(const std::string& setting) {
  for (Case c : coherence_cases(false)) {
    if (c.view.scene != "chess" || c.setting != setting) continue;
    c.width = 64;
    c.height = 32;
    Options options;
    options.config = "rt-warp-like";
    const std::vector<Measured> values = Runner(options).measure_case(c);
    std::map<std::string, double> figures;
    for (std::size_t i = 0; i < values.size(); ++i) figures[c.metrics[i].metric] = values[i].value.value();
    return figures;
  }
  throw std::logic_error("there is no setting " + setting);
}

TEST(IncoherentRays, StackPrefetchIsAccurateButCoversLessThanPublished) {  // K1
  const auto stack = coherence_metrics("stack prefetch, path rays");
  expect_between("accuracy, published 0.989", stack.at("prefetch_accuracy"), 0.9, 0.95);
  expect_between("coverage, published 0.315", stack.at("prefetch_coverage"), 0.08, 0.2);
  expect_between("speed-up, published 1.48", stack.at("speedup"), 1.03, 1.15);
  EXPECT_LT(stack.at("speedup"), coherence_metrics("ideal L1, path rays").at("speedup"));
}

TEST(IncoherentRays, NoMechanismReachesAnL1ThatAlwaysHits) {  // K2
  const double bound = coherence_metrics("ideal L1, path rays").at("speedup");
  EXPECT_GT(bound, 1.5);
  for (const char* mechanism : {"treelet prefetch, path rays", "sort, path rays", "gather, path rays"}) {
    EXPECT_LT(coherence_metrics(mechanism).at("speedup"), bound) << mechanism;
  }
}

}  // namespace
}  // namespace tools::reproduce
