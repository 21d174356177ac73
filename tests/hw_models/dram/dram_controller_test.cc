#include <algorithm>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/dram/dram_device.h"
#include "hw_models/dram/dram_measurements.h"
#include "sim/hash.h"
#include "tests/hw_models/dram/dram_harness.h"
#include "tests/param_name.h"

// Tests of page policies, schedulers and a device of two ranks, and of every kind of controller in every engine mode.

namespace hw::test {
namespace {

DramConfig with_policy(PagePolicy policy) {
  return with([&](DramConfig& c) { c.controller.page_policy = policy; });
}

TEST(ClosedPages, MakeEverySingleReadOneOfAClosedBank) {
  Script s(with_policy(PagePolicy::kClosed));
  s.read(0, 1);
  s.read(0, 1, 1000);
  s.read(0, 2, 2000);
  s.go();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(s.latency(i), kForm.closed_bank_latency());
  EXPECT_EQ(s.result.stats.row_misses, 3U);
}

TEST(ClosedPages, StayOpenForHitsThatWait) {
  Script s(with_policy(PagePolicy::kClosed));
  for (Addr i = 0; i < 10; ++i) s.read(0, 1, 0, i);
  s.go();
  EXPECT_EQ(s.result.stats.activates, 1U);
  EXPECT_EQ(s.result.stats.row_hits, 9U);
}

TEST(ClosedPages, ARowIsClosedNoSoonerThanItsTimesAllow) {
  Script s(with_policy(PagePolicy::kClosed));
  s.read(0, 1);
  s.read(0, 2, kT.rcd + 1);  // arrives after row 1's only hit is served
  s.go();
  const std::uint64_t precharge = std::max(kT.ras, kT.rcd + kT.ccd_l + kT.rtp);
  EXPECT_EQ(s.done(1), std::max<std::uint64_t>(precharge + kT.rp, kT.rc) +
                           static_cast<std::uint64_t>(kForm.closed_bank_latency()));
}

TEST(AdaptivePages, AreClosedIfTheNextRequestNeedsAnotherRow) {
  Script s(with_policy(PagePolicy::kAdaptive));
  for (std::uint64_t i = 0; i < 6; ++i) s.read(0, i, 1000 * i);
  s.go();
  EXPECT_EQ(s.latency(1), kForm.row_conflict_latency());
  EXPECT_EQ(s.latency(2), kForm.row_conflict_latency());
  for (const std::size_t i : {3U, 4U, 5U})
    EXPECT_EQ(s.latency(i), kForm.closed_bank_latency()) << "two in a row are enough";
}

TEST(AdaptivePages, StayOpenAgainIfTheNextRequestNeedsTheSameRow) {
  Script s(with_policy(PagePolicy::kAdaptive));
  for (std::uint64_t i = 0; i < 6; ++i) s.read(0, i, 1000 * i);
  for (std::uint64_t i = 6; i < 12; ++i) s.read(0, 5, 1000 * i);
  s.go();
  EXPECT_EQ(s.latency(6), kForm.closed_bank_latency());
  for (const std::size_t i : {9U, 10U, 11U}) EXPECT_EQ(s.latency(i), kForm.row_hit_latency());
}

TEST(Scheduler, FirstComeFirstServedNeitherOvertakesNorPreparesBanks) {
  std::array<Script, 2> scripts{
      Script(DramHarness::quiet()),
      Script(with([](DramConfig& c) { c.controller.scheduler = DramSchedulingPolicy::kFcfs; }))};
  for (Script& s : scripts) {
    s.read(0, 1);
    s.read(0, 2);
    s.read(0, 1, 0, 1);
    s.read(1, 1);
    s.go();
  }
  EXPECT_LT(scripts[0].done(2), scripts[0].done(1)) << "a row hit goes first";
  EXPECT_LT(scripts[0].done(3), scripts[0].done(1)) << "another bank is made ready meanwhile";
  const Script& in_turn = scripts[1];
  for (std::size_t i = 1; i < 4; ++i) EXPECT_LT(in_turn.done(i - 1), in_turn.done(i));
  const std::uint64_t third = in_turn.done(2) - static_cast<std::uint64_t>(kForm.row_hit_latency());
  EXPECT_EQ(in_turn.done(3), third + kT.ca_column + static_cast<std::uint64_t>(kForm.closed_bank_latency()))
      << "the bank is opened in the first gap after the third read's first command";
}

TEST(Ranks, HaveActivateWindowsOfTheirOwn) {
  DramConfig c = with([](DramConfig& d) { d.organisation.ranks = 2; });
  Script s(c);
  s.read(0, 0);
  s.read(8, 0);  // the first bank of the other rank
  s.read(1, 0, 1000);
  s.read(2, 0, 1000);
  s.go();
  EXPECT_EQ(s.done(1) - s.done(0), 2 * kT.burst + kT.rtrs) << "only the data bus keeps them apart";
  EXPECT_EQ(s.done(3) - s.done(2), std::max(kT.rrd, 2 * kT.burst)) << "tRRD, within a rank";
  EXPECT_GT(s.why(DramCycleReason::kRankSwitch), 0U);
}

TEST(Ranks, AreRefreshedInTurn) {
  DramConfig c = with([](DramConfig& d) {
    d.organisation.ranks = 2;
    d.timing.refi_pb = 780;
  });
  Script s(c);
  s.read(0, 0, 780);
  s.read(8, 0, 780);  // its rank's refresh is half an interval later
  s.read(0, 0, 780'000);
  s.go();
  EXPECT_EQ(s.latency(0), kT.rfc_pb - 1 + kForm.closed_bank_latency());
  EXPECT_LT(s.latency(1), kForm.closed_bank_latency() + 2 * kT.burst);
  EXPECT_NEAR(static_cast<double>(s.result.stats.refreshes), 2000.0, 2.0);
  const std::uint64_t cycles = s.done(2);
  EXPECT_EQ(s.result.stats.active_standby + s.result.stats.precharge_standby, 2 * cycles) << "of either rank";
}

TEST(Ranks, AreAboveTheirBanksInTheAddress) {
  DramConfig c = with([](DramConfig& d) {
    d.organisation.ranks = 2;
    d.controller.bank_xor = true;
  });
  const DramMap map(c);
  const Addr pages = c.organisation.page.bytes;
  EXPECT_EQ(map.address_of(7 * pages).bank, 7U);
  EXPECT_EQ(map.address_of(8 * pages).bank, 8U);
  EXPECT_EQ(map.address_of(16 * pages).row, 1U);
  EXPECT_EQ(map.address_of(16 * pages).bank, 1U) << "row 1 changes the bank";
  EXPECT_EQ(map.address_of((8 * 16 + 8) * pages).bank, 8U) << "row 8 does not change the rank";
}

TEST(IdealChannel, AnswersAnyNumberACycleLater) {
  DramHarness b(DramHarness::quiet(), 3, 64, true);
  for (std::uint64_t i = 0; i < 300; ++i) b.requester(i % 3).send(sim::hash(i) % 65536 * 64, 0, i % 5 == 4);
  b.run();
  for (std::size_t r = 0; r < 3; ++r) {
    for (const auto& sent : b.requester(r).script) {
      if (!sent.request.write) {
        EXPECT_EQ(sent.latency(), DramHarness::kWires);
      }
    }
    EXPECT_EQ(b.requester(r).script[99].cycle, 99U) << "no request waits";
  }
  EXPECT_EQ(b.stats().reads + b.stats().writes, 300U);
  EXPECT_EQ(b.stats().read_bursts, 2 * b.stats().reads);
  EXPECT_EQ(b.stats().activates + b.stats().refreshes, 0U);
}

TEST(Controllers, OfEveryKindDoNotDependOnTheEngine) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      DramConfig c = DramHarness::quiet();
      c.controller.page_policy = static_cast<PagePolicy>(seed % 3);
      c.controller.refresh = static_cast<RefreshKind>(seed / 3 % 2);
      c.controller.power_down = seed / 6 % 2 == 1;
      c.controller.power_down_after = seed % 5 == 0 ? 1 : 160;
      c.controller.scheduler = static_cast<DramSchedulingPolicy>(sim::hash(seed) % 2);
      c.controller.bank_xor = seed % 2 == 1;
      c.organisation.ranks = seed / 12 % 2 + 1;
      c.organisation.refresh_banks = sim::hash(seed, 1) % 2 + 1;
      c.timing.refi_pb = 780;
      c.timing.refi_ab = 1600;
      const bool ideal = seed == 23;
      DramHarness b(c, 3, seed % 4 == 0 ? 1 : 8, ideal);
      b.requester(0).pop_every = seed % 7 == 0 ? 50 : 1;
      for (std::uint64_t i = 0; i < 900; ++i) {
        const std::uint64_t pause = i / 150 * 4321;
        b.requester(i % 3).send(sim::hash(i, seed) % (seed % 2 == 0 ? 100000 : 512) * 64, pause + i % 150 * (seed % 4),
                                sim::hash(i, seed, 1) % 3 == 0);
      }
      const std::uint64_t cycles = b.run(mode);
      std::uint64_t spent = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(DramCycleReason::kCount); ++i) {
        spent += b.why(static_cast<DramCycleReason>(i));
      }
      EXPECT_EQ(spent, cycles);
      const DramChannel::Stats& s = b.stats();
      EXPECT_EQ(s.active_standby + s.precharge_standby + s.power_down, c.organisation.ranks * cycles);
      // The second share is what remains, so their sum is right even if they overlap.
      for (const std::uint64_t part : {s.active_standby, s.precharge_standby, s.power_down}) {
        EXPECT_LE(part, c.organisation.ranks * cycles) << "seed " << seed;
      }
      EXPECT_EQ(s.reads + s.writes, 900U);
      const std::string all = b.harness.everything(b.end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << "seed " << seed;
    }
  }
}

constexpr std::uint32_t kBank = 5, kRow = 7;

/// Serves the last queued hit of a row, then a request for `row` arrives. Returns true if the first row was closed.
bool closes_before(DramPagePolicy& policy, std::uint32_t row) {
  const bool closed = policy.should_close_row(kBank, kRow, false);
  policy.note_request(kBank, row);
  return closed;
}

TEST(DramPagePolicy, ForgetsManyOtherRowsAfterTwoOfTheSame) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(policy.should_close_row(kBank, kRow, true)) << "another row waits";
  EXPECT_TRUE(closes_before(policy, kRow)) << "the count ends at 3";
  EXPECT_TRUE(closes_before(policy, kRow)) << "2: the upper half";
  EXPECT_FALSE(closes_before(policy, kRow)) << "1";
}

TEST(DramPagePolicy, ForgetsManyOfTheSameAfterTwoOtherRows) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(closes_before(policy, kRow));
  EXPECT_FALSE(closes_before(policy, kRow + 1)) << "0";
  EXPECT_FALSE(closes_before(policy, kRow + 1)) << "1";
  EXPECT_TRUE(closes_before(policy, kRow + 1)) << "2";
}

TEST(DramPagePolicy, CountsOnlyTheNextRequest) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  EXPECT_FALSE(closes_before(policy, kRow + 1));
  for (int i = 0; i < 10; ++i) policy.note_request(kBank, kRow + 1);
  EXPECT_FALSE(policy.should_close_row(kBank, kRow, false)) << "1";
}

TEST(DramPagePolicy, CountsForEachBankSeparately) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(policy.should_close_row(kBank, kRow, true));
  for (std::uint32_t bank = 0; bank < 32; ++bank) EXPECT_EQ(policy.should_close_row(bank, kRow, false), bank == kBank);
}

DramQueue::Entry entry(std::uint32_t bank, std::uint32_t row) {
  DramQueue::Entry e;
  e.address = {bank, row};
  return e;
}

/// A queue with requests for rows 10 and 11 of bank 3, whose row 10 is open, and for a closed row of bank 31.
DramQueue four() {
  DramQueue queue(4, 32);
  queue.push(entry(3, 10), true);
  queue.push(entry(31, 20), false);
  queue.push(entry(3, 11), false);
  queue.push(entry(3, 10), true);
  return queue;
}

TEST(DramQueue, TracksRequestsByBankAndHitsOfItsOpenRow) {
  DramQueue queue = four();
  EXPECT_TRUE(queue.is_full());
  EXPECT_EQ(queue.requested_bank_mask(), 1U << 3 | 1U << 31);
  EXPECT_EQ(queue.hit_bank_mask(), 1U << 3);
  EXPECT_EQ(queue.request_position_mask(3), 0b1101U);
  EXPECT_EQ(queue.request_position_mask(31), 0b0010U);
  EXPECT_EQ(queue.hit_position_mask(3), 0b1001U);
  EXPECT_EQ(queue.hit_position_mask(31), 0U);
}

TEST(DramQueue, MovesLaterRequestsUpWhenOneIsRemoved) {
  DramQueue queue = four();
  queue.remove_at(1);
  EXPECT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue.requested_bank_mask(), 1U << 3);
  EXPECT_EQ(queue.request_position_mask(3), 0b111U);
  EXPECT_EQ(queue.request_position_mask(31), 0U);
  EXPECT_EQ(queue.hit_position_mask(3), 0b101U);
  EXPECT_EQ(queue.at(1).address.row, 11U);
  queue.remove_at(0);
  EXPECT_EQ(queue.oldest_entry().address.row, 11U);
  EXPECT_EQ(queue.hit_position_mask(3), 0b10U);
  queue.remove_at(1);
  EXPECT_EQ(queue.hit_bank_mask(), 0U);
  queue.remove_at(0);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.requested_bank_mask(), 0U);
}

TEST(DramQueue, UpdatesHitsWhenARowOpensOrCloses) {
  DramQueue queue = four();
  queue.note_row_opened(3, 11);
  EXPECT_EQ(queue.hit_position_mask(3), 0b100U);
  queue.note_row_opened(31, 20);
  EXPECT_EQ(queue.hit_bank_mask(), 1U << 3 | 1U << 31);
  queue.note_row_closed(3);
  EXPECT_EQ(queue.hit_position_mask(3), 0U);
  EXPECT_EQ(queue.hit_bank_mask(), 1U << 31);
}

TEST(DramQueue, FindsTheRequestsOfSeveralBanks) {
  const DramQueue queue = four();
  EXPECT_EQ(queue.request_position_mask_of_banks(1U << 3), 0b1101U);
  EXPECT_EQ(queue.hit_position_mask_of_banks(1U << 3), 0b1001U);
  EXPECT_EQ(queue.request_position_mask_of_banks(1U << 3 | 1U << 31), 0b1111U);
  EXPECT_EQ(queue.hit_position_mask_of_banks(1U << 31), 0U);
  EXPECT_EQ(queue.request_position_mask_of_banks(0), 0U);
}

TEST(DramQueue, HoldsSixtyFour) {
  DramQueue queue(64, 32);
  for (std::uint32_t i = 0; i < 64; ++i) queue.push(entry(i % 32, i), true);
  EXPECT_TRUE(queue.is_full());
  EXPECT_EQ(queue.request_position_mask(31), std::uint64_t{1} << 31 | std::uint64_t{1} << 63);
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_EQ(queue.oldest_entry().address.row, i);
    queue.remove_at(0);
  }
}

constexpr std::uint64_t kNobody = std::numeric_limits<std::int64_t>::max();

/// Small numbers, so that many are equal.
BankLanes some(std::uint32_t banks, std::uint64_t seed) {
  BankLanes lanes(banks);
  for (std::uint32_t bank = 0; bank < banks; ++bank) lanes[bank] = sim::hash(seed, bank) % 16;
  return lanes;
}

std::uint32_t first(std::uint32_t banks) { return static_cast<std::uint32_t>((std::uint64_t{1} << banks) - 1); }

/// Expected results, computed bank by bank.
struct OneByOne {
  const BankLanes &a, &b;
  std::uint32_t banks;

  template <class Holds>
  std::uint32_t all_that(Holds&& holds) const {
    std::uint32_t mask = 0;
    for (std::uint32_t bank = 0; bank < banks; ++bank) mask |= std::uint32_t{holds(bank)} << bank;
    return mask;
  }
  template <class Number>
  std::uint64_t least(std::uint32_t of, Number&& number) const {
    std::uint64_t least = kNobody;
    for (std::uint32_t bank = 0; bank < banks; ++bank) {
      if ((of >> bank & 1) != 0) least = std::min(least, number(bank));
    }
    return least;
  }
};

class BankLanesOf : public testing::TestWithParam<std::uint32_t> {};

TEST_P(BankLanesOf, EqualABankByBankReference) {
  const std::uint32_t banks = GetParam();
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const BankLanes a = some(banks, seed), b = some(banks, seed + 1000);
    const OneByOne expected{a, b, banks};
    const std::uint64_t most = seed % 16;
    const auto of = static_cast<std::uint32_t>(sim::hash(seed, 77U)) & first(banks);
    const auto larger = [&](std::uint32_t bank) { return std::max(a[bank], b[bank]); };
    EXPECT_EQ(a.banks_with_value_at_most(most) & first(banks),
              expected.all_that([&](std::uint32_t i) { return a[i] <= most; }));
    EXPECT_EQ(a.banks_with_both_at_most(b, most) & first(banks),
              expected.all_that([&](std::uint32_t i) { return larger(i) <= most; }));
    BankLanes raised = a;
    raised.raise_to_at_least(of, most);
    for (std::uint32_t i = 0; i < banks; ++i) {
      EXPECT_EQ(raised[i], (of >> i & 1) != 0 ? std::max(a[i], most) : a[i]);
    }
    EXPECT_EQ(a.min_of(of), expected.least(of, [&](std::uint32_t i) { return a[i]; }));
    EXPECT_EQ(a.min_of_maxima_with(b, of), expected.least(of, larger));
    std::uint64_t any = 0;
    for (std::uint32_t bank = 0; bank < banks; ++bank) any |= (of >> bank & 1) != 0 ? a[bank] : 0;
    EXPECT_EQ(a.bitwise_or_of(of), any);
  }
}

TEST_P(BankLanesOf, AreAllReplaced) {
  BankLanes lanes = some(GetParam(), 3);
  const BankLanes before = lanes;
  lanes.transform_all([](std::uint64_t number) { return 3 * number + 1; });
  for (std::uint32_t bank = 0; bank < GetParam(); ++bank) EXPECT_EQ(lanes[bank], 3 * before[bank] + 1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BankLanesOf, testing::Values(1U, 2U, 4U, 8U, 16U, 32U), ::test::ParamName());

TEST(BankLanes, HoldWhatTakesAllBitsOfACycle) {
  BankLanes lanes(8);
  lanes[5] = std::uint64_t{1} << 62;
  EXPECT_EQ(lanes.banks_with_value_at_most((std::uint64_t{1} << 62) - 1), 0xdfU);
  EXPECT_EQ(lanes.banks_with_value_at_most(std::uint64_t{1} << 62), 0xffU);
  EXPECT_EQ(lanes.min_of(1U << 5), std::uint64_t{1} << 62);
  EXPECT_EQ(lanes.min_of(0), kNobody);
}

}  // namespace

}  // namespace hw::test
