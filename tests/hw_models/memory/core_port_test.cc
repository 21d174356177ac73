#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/memory/bank_harness.h"
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

/// Returns the order in which an arbiter serves requesters that are always ready and have waited since given times.
std::vector<std::uint32_t> order(Arbitration how, std::array<sim::Time, 3> since) {
  Arbiter arbiter(how, 3);
  std::vector<std::uint32_t> served;
  for (int i = 0; i < 5; ++i) {
    const std::uint32_t next = arbiter.choose_requester(
        7, [&](std::uint32_t a) { return since[a] != 0; }, [&](std::uint32_t a) { return since[a]; });
    served.push_back(next);
    if (next == arbiter.requester_count()) continue;
    arbiter.note_served(next);
    since[next] += 10;
  }
  return served;
}

using Order = std::vector<std::uint32_t>;

TEST(Arbiter, RoundRobinIgnoresTheOrderOfArrival) {
  EXPECT_EQ(order(Arbitration::kRoundRobin, {30, 20, 10}), (Order{0, 1, 2, 0, 1}));
  EXPECT_EQ(order(Arbitration::kRoundRobin, {30, 0, 10}), (Order{0, 2, 0, 2, 0})) << "who is not ready is passed over";
}

TEST(Arbiter, OldestFirstServesTheLowestNumberOfEquals) {
  EXPECT_EQ(order(Arbitration::kOldestFirst, {30, 15, 10}), (Order{2, 1, 2, 1, 0}));
  EXPECT_EQ(order(Arbitration::kOldestFirst, {10, 10, 10}), (Order{0, 1, 2, 0, 1}));
}

TEST(Arbiter, FixedServesTheFirstThatIsReady) {
  EXPECT_EQ(order(Arbitration::kFixed, {30, 20, 10}), (Order{0, 0, 0, 0, 0}));
  EXPECT_EQ(order(Arbitration::kFixed, {0, 20, 10}), (Order{1, 1, 1, 1, 1}));
  EXPECT_EQ(order(Arbitration::kFixed, {0, 0, 0}), (Order{3, 3, 3, 3, 3})) << "no requests";
}

TEST(Arbiter, FixedLetsTheLastClientOfAPortWait) {
  PortHarness b(2, 1, 64, 1, 64, Arbitration::kFixed);
  for (std::size_t c : {0U, 1U})
    for (Addr i = 0; i < 40; ++i) b.client(c).send(64 * i);
  b.harness.run();
  EXPECT_GT(b.client(1).script[0].answered, b.client(0).script[38].answered);
}

TEST(Arbiter, OldestFirstServesALateClientOfAPortLast) {
  PortHarness b(2, 1, 64, 1, 64, Arbitration::kOldestFirst);
  for (Addr i = 0; i < 20; ++i) b.client(0).send(64 * i, 0, true);
  b.client(1).send(0, 10);
  b.client(0).send(0, 30);
  b.harness.run();
  // Client 0 sends one write per cycle, so the request of cycle 10 competes with the write of cycle 10.
  EXPECT_EQ(b.client(1).script[0].latency(), 1U + 1 + 1 + 1 + 1) << "one write of the same age goes first";
}

TEST(Arbiter, ArbitratesTheCoresOfABankToo) {
  for (const Arbitration how : {Arbitration::kFixed, Arbitration::kRoundRobin}) {
    BankHarness b(BankHarness::small(), 2, 64, 50, how);
    b.core(0).send(0);
    for (std::size_t core : {0U, 1U})
      for (int i = 0; i < 30; ++i) b.core(core).send(0, 200);
    b.harness.run();
    const bool last = b.core(1).script[0].answered > b.core(0).script[29].answered;
    EXPECT_EQ(last, how == Arbitration::kFixed);
  }
}

TEST(Arbiter, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const Arbitration how : {Arbitration::kOldestFirst, Arbitration::kFixed}) {
    for (const bool ideal : {false, true}) {
      std::string expected;
      for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
        PortHarness b(3, 2, 4, 3, 8, how, ideal);
        b.client(1).pop_every = 7;
        for (std::uint64_t i = 0; i < 900; ++i) {
          b.client(i % 3).send(sim::hash(i) % 64 * 64, i * (i % 7) / 4, sim::hash(i, 1) % 4 == 0,
                               static_cast<SectorMask>(sim::hash(i, 3) % 255 + 1));
        }
        const sim::Time end = b.harness.run(mode);
        const std::string all = b.harness.everything(end);
        if (mode == Mode::kSkip) expected = all;
        ASSERT_EQ(all, expected) << static_cast<int>(how) << ideal;
        EXPECT_EQ(b.port().stats().requests, 900U);
      }
    }
  }
}

TEST(CorePort, SectorsOccupyTheWiresUpForTheirLength) {
  for (const SectorMask sectors : {SectorMask{0x01}, SectorMask{0x0f}, kWholeLine}) {
    PortHarness b(1, 1, 64, 1, 8);
    for (Addr i = 0; i < 20; ++i) b.client(0).send(64 * i, 0, true, sectors);
    b.client(0).send(0);
    b.harness.run();
    const auto cycles = static_cast<std::uint64_t>(std::popcount(sectors));
    EXPECT_EQ(b.client(0).script[20].answered, 1 + 20 * cycles + 1 + 1 + 1);
  }
}

TEST(CorePort, CountsHowLongRequestsAndLinesWait) {
  PortHarness b(1, 1, 64, 1, 16);
  for (Addr i = 0; i < 4; ++i) b.client(0).send(64 * i);
  b.harness.run();
  EXPECT_EQ(b.port().stats().request_wait, 0U) << "one a cycle, as they come";
  EXPECT_EQ(b.port().stats().line_wait, 3U + 6 + 9) << "a line takes four cycles and comes each cycle";
}

}  // namespace
}  // namespace hw::test
