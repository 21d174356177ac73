#include <algorithm>

#include <gtest/gtest.h>

#include "tests/hw_models/memory/port_harness.h"

namespace hw::test {
namespace {

TEST(CorePort, ASingleRequestTakesTheWiresBothWays) {
  PortHarness b(1, 1, 8, 5);
  b.client(0).send(640);
  b.harness.run();
  EXPECT_EQ(b.client(0).script[0].latency(), 1U + 5 + 1 + 5) << "client wire, up, memory's wire, down";
  EXPECT_EQ(b.port().stats().requests, 1U);
  EXPECT_EQ(b.port().stats().lines_down, 1U);
}

TEST(CorePort, ALineOccupiesTheWiresDownForItsLengthOverTheWidth) {
  for (const std::uint32_t width : {16U, 32U, 64U}) {
    PortHarness b(1, 4, 64, 1, width);
    for (Addr i = 0; i < 40; ++i) b.client(0).send(64 * i);
    b.harness.run();
    EXPECT_EQ(b.client(0).script[39].answered - b.client(0).script[0].answered, 39 * (64U / width));
    EXPECT_EQ(b.why(CorePort::CycleReason::kLine), 39 * (64U / width) + std::min(64U / width, 2U))
        << "the run ends with the answer, two cycles into the last line";
  }
}

TEST(CorePort, RequestsGoToTheTargetOfTheirLine) {
  PortHarness b(1, 4, 8);
  for (Addr i = 0; i < 12; ++i) b.client(0).send(64 * (4 * i + i % 3));
  b.harness.run();
  for (std::size_t t = 0; t < 3; ++t) EXPECT_EQ(b.target(t).requests, 4U);
  EXPECT_EQ(b.target(3).requests, 0U);
}

TEST(CorePort, ClientsTakeTurns) {
  PortHarness b(3, 1, 64);
  for (std::size_t c = 0; c < 3; ++c)
    for (Addr i = 0; i < 30; ++i) b.client(c).send(64 * i);
  b.harness.run();
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_LE(b.client(2).script[i].answered - b.client(0).script[i].answered, 4U) << "two lines of two cycles between";
  }
}

TEST(CorePort, AWriteOccupiesTheWiresUp) {
  PortHarness b(1, 1, 64);
  for (Addr i = 0; i < 20; ++i) b.client(0).send(64 * i, 0, true);
  b.client(0).send(0);
  b.harness.run();
  EXPECT_EQ(b.client(0).script[20].answered, 1 + 20 * 2 + 1 + 1 + 1U);
  EXPECT_EQ(b.port().stats().lines_up, 20U);
}

TEST(CorePort, ABlockedTargetDoesNotBlockClientsOfOthers) {
  PortHarness b(2, 2, 1);
  b.client(0).pop_every = 200;
  for (Addr i = 0; i < 6; ++i) b.client(0).send(128 * i);
  for (Addr i = 0; i < 50; ++i) b.client(1).send(128 * i + 64);
  b.harness.run();
  EXPECT_LT(b.client(1).script[49].answered, 400U);
  EXPECT_GT(b.why(CorePort::CycleReason::kClientFull), 400U);
}

TEST(CorePort, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const std::size_t capacity : {1U, 2U, 8U}) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      PortHarness b(3, 2, capacity, capacity, capacity == 2 ? 8 : 32);
      b.client(1).pop_every = 7;
      for (std::uint64_t i = 0; i < 900; ++i)
        b.client(i % 3).send(sim::hash(i) % 64 * 64, sim::hash(i, 2) % 4000 / 4 * (i % 7), sim::hash(i, 1) % 4 == 0);
      const sim::Time end = b.harness.run(mode);
      const std::string all = b.harness.everything(end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << "capacity " << capacity;
      const CorePort::Stats& s = b.port().stats();
      EXPECT_EQ(s.requests, 900U);
      EXPECT_EQ(s.lines_down + s.lines_up, 900U);
      std::uint64_t sum = 0;
      for (std::size_t w = 0; w < static_cast<std::size_t>(CorePort::CycleReason::kCount); ++w)
        sum += b.why(static_cast<CorePort::CycleReason>(w));
      EXPECT_EQ(sum, b.elapsed());
      EXPECT_EQ(b.elapsed(), kClock.cycles(end) + 1);
    }
  }
}

}  // namespace
}  // namespace hw::test
