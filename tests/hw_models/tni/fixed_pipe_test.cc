#include "hw_models/tni/fixed_pipe.h"

#include <deque>

#include <gtest/gtest.h>

#include "sim/hash.h"

namespace hw::test {
namespace {

TEST(FixedPipe, EachSlotComesOutALatencyLaterAndGoesItsWay) {
  for (const std::uint32_t latency : {1U, 2U, 13U, 63U}) {
    FixedPipe pipe(latency);
    struct Inside {
      std::uint64_t at;
      std::uint32_t slot;
      std::size_t way;
    };
    std::deque<Inside> expected;
    for (std::uint64_t cycle = 1000; cycle < 3000; ++cycle) {
      std::uint64_t cycles = 0;
      for (const Inside& inside : expected) cycles |= std::uint64_t{1} << (inside.at - cycle);
      ASSERT_EQ(pipe.comes_out(cycle), cycles);
      const FixedPipe::Out out = pipe.take(cycle);
      if (expected.empty() || expected.front().at != cycle) {
        ASSERT_EQ(out.slots, 0U) << cycle;
      } else {
        ASSERT_EQ(out.slots, std::uint64_t{1} << expected.front().slot);
        ASSERT_EQ(out.way, expected.front().way);
        expected.pop_front();
      }
      if (sim::hash(latency, cycle) % 3 == 0) continue;
      const auto slot = static_cast<std::uint32_t>(sim::hash(cycle, 1) % 64);
      const std::size_t way = sim::hash(cycle, 2) % 4;
      pipe.put(slot, way, cycle);
      expected.push_back({cycle + latency, slot, way});
    }
  }
}

}  // namespace
}  // namespace hw::test
