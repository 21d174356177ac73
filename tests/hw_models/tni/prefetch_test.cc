#include <gtest/gtest.h>

#include "tests/hw_models/tni/harness.h"

namespace hw {
namespace {

using test::one_trv;
using test::TniHarness;
using traces::visit_step;

/// Returns the prefetches of a ray that hits both children of the root, which are inner nodes.
Trv::Stats of(Prefetch prefetch, std::uint32_t registers) {
  TniHarness::Setup setup = one_trv();
  setup.links.resize(3);
  setup.links[0].child[0] = 1;
  setup.links[0].child[1] = 2;
  setup.config.trv.prefetch = prefetch;
  setup.config.trv.l1.mshrs = registers;
  TniHarness harness(setup);
  harness.add({visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), traces::end_step(false)}).run();
  return harness.tni().trvs().front()->stats();
}

TEST(Prefetch, ProbesAndFetchesAreCountedOnceForEachFarNode) {
  EXPECT_EQ(of(Prefetch::kSibling, 8).prefetch_probes, 1U);
  EXPECT_EQ(of(Prefetch::kSibling, 8).prefetches, 1U);
  EXPECT_EQ(of(Prefetch::kNone, 8).prefetch_probes, 0U);
}

TEST(Prefetch, NothingIsProbedWithoutASpareMshr) {
  EXPECT_EQ(of(Prefetch::kSibling, 2).prefetch_probes, 0U);
  EXPECT_EQ(of(Prefetch::kSibling, 2).prefetches, 0U);
}

}  // namespace
}  // namespace hw
