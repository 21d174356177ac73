#include <gtest/gtest.h>

#include "tests/hw_models/memory/bank_harness.h"
#include "tests/hw_models/memory/port_harness.h"

namespace hw::test {
namespace {

TEST(IdealL2, AnswersEveryRequestACycleLater) {
  BankHarness b(BankHarness::small(), 3, 64, 50, Arbitration::kRoundRobin, true);
  for (std::size_t core = 0; core < 3; ++core)
    for (Addr i = 0; i < 40; ++i) b.core(core).send(64 * (100 * core + i), 5);
  b.harness.run();
  for (std::size_t core = 0; core < 3; ++core) {
    for (const Requester::Sent& sent : b.core(core).script) EXPECT_EQ(sent.latency(), 1U + 1 + 1) << "wire, bank, wire";
  }
  EXPECT_EQ(b.stats().hits, 120U);
  EXPECT_EQ(b.stats().latency, 120U);
  EXPECT_EQ(b.fetched(), 0U);
}

TEST(IdealL2, KeepsWhatIsWritten) {
  BankHarness b(BankHarness::small(), 1, 64, 50, Arbitration::kRoundRobin, true);
  for (Addr i = 0; i < 40; ++i) b.core(0).send(64 * i, 0, true);
  b.core(0).send(0);
  b.harness.run();
  EXPECT_EQ(b.stats().stored, 40U);
  EXPECT_EQ(b.fetched(), 0U);
}

TEST(IdealL2, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const std::size_t capacity : {1U, 4U}) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      BankHarness b(BankHarness::small(), 3, capacity, 50, Arbitration::kRoundRobin, true);
      b.core(1).pop_every = 20;
      for (std::uint64_t i = 0; i < 900; ++i) {
        b.core(i % 3).send(sim::hash(i) % 64 * 64, i * (i % 7) / 4, sim::hash(i, 1) % 4 == 0);
      }
      const sim::Time end = b.harness.run(mode);
      const std::string all = b.harness.everything(end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << capacity;
      EXPECT_EQ(b.stats().reads + b.stats().writes, 900U);
      EXPECT_GT(b.why(L2Bank::CycleReason::kOutputFull), 100U);
      EXPECT_EQ(kClock.cycles(b.harness.banks.front()->activity().accounted_until()), kClock.cycles(end) + 1);
    }
  }
}

TEST(IdealInterconnect, CarriesAllRequestsAndLinesOfACycleAtOnce) {
  PortHarness b(3, 2, 64, 1, 8, Arbitration::kRoundRobin, true);
  for (std::size_t c = 0; c < 3; ++c)
    for (Addr i = 0; i < 30; ++i) b.client(c).send(64 * (c % 2), 5, i % 5 == 0);
  b.harness.run();
  // Each target's memory answers one request per cycle. The first target has two clients, the second has one.
  for (const Requester::Sent& sent : b.client(1).script) {
    if (!sent.request.write) {
      EXPECT_EQ(sent.latency(), 4U);
    }
  }
  EXPECT_EQ(b.port().stats().request_wait, 0U);
  EXPECT_EQ(b.port().stats().line_wait, 0U);
}

}  // namespace
}  // namespace hw::test
