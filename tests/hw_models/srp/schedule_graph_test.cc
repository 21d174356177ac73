#include "hw_models/srp/schedule_graph.h"

#include <gtest/gtest.h>

#include "tests/hw_models/srp/graph_builder.h"

namespace hw::test {
namespace {

std::size_t operations_of_load(std::uint32_t bytes, kernels::Op op = kernels::Op::kLoadLocal) {
  GraphBuilder g;
  g.load(bytes, g.item(), op);
  return ScheduleGraph(g.graph(), {}).operations().size();
}

TEST(ScheduleGraph, ALocalLoadIsAnOperationForEverySixteenBytesThatItBegins) {
  EXPECT_EQ(operations_of_load(1), 1U);
  EXPECT_EQ(operations_of_load(16), 1U);
  EXPECT_EQ(operations_of_load(17), 2U);
  EXPECT_EQ(operations_of_load(32), 2U);
  EXPECT_EQ(operations_of_load(33), 3U);
}

TEST(ScheduleGraph, ACachedLoadIsAnOperationForEveryWidthOfThePortThatItBegins) {
  EXPECT_EQ(operations_of_load(4, kernels::Op::kLoadCached), 1U);
  EXPECT_EQ(operations_of_load(64, kernels::Op::kLoadCached), 1U);
  EXPECT_EQ(operations_of_load(65, kernels::Op::kLoadCached), 2U);
}

}  // namespace
}  // namespace hw::test
