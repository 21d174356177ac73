#include "sim/machine.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include <gtest/gtest.h>

#include "sim/engine.h"

// Tests of properties that a machine derives from declared units and links.

namespace sim::test {
namespace {

enum class Side : std::uint8_t { kNear, kFar };
constexpr std::array<std::string_view, 2> names_of(Side) { return {"near", "far"}; }

/// Test unit that forwards numbers, one at a time.
class Relay {
 public:
  static constexpr Side kBlock = Side::kFar;
  enum class CycleReason : std::uint8_t { kIdle, kCount };
  static constexpr auto kReasons =
      reasons<CycleReason>({{CycleReason::kIdle, sim::idle_reason("idle", "nothing comes")}});
  struct Stats {
    std::uint64_t taken = 0;
    static void describe(auto& s, auto&& counter) { counter(NAMED(s.taken), "numbers handed on"); }
  };

  Relay(Clock clock, Link<int>* in, Link<int>* out, int numbers = 0)
      : clock_(clock), in_(in), out_(out), numbers_(numbers) {}

  Time tick(Time now) {
    if (numbers_ > 0 && out_->can_push(now)) out_->push(now, numbers_--);
    if (in_ != nullptr && in_->can_pop(now) && (out_ == nullptr || out_->can_push(now))) {
      const int number = in_->pop(now);
      if (out_ != nullptr) out_->push(now, number);
      stats_.taken += 1;
      last = now;
    }
    const Time next = clock_.edge_after(now, 1);
    const Time give = numbers_ > 0 ? std::max(next, out_->push_at()) : kNever;
    return in_ == nullptr ? give : std::min(give, std::max(next, in_->pop_at()));
  }
  Clock clock() const { return clock_; }
  void finish(Time end) { activity_.finish(end); }
  std::string state() const { return numbers_ > 0 ? "has numbers" : ""; }
  bool idle() const { return numbers_ == 0; }
  const Stats& stats() const { return stats_; }
  const Activity<CycleReason>& activity() const { return activity_; }

  Time last = 0;

 private:
  Clock clock_;
  Link<int>*in_, *out_;
  int numbers_;
  Stats stats_;
  Activity<CycleReason> activity_;
};

/// A machine of two units: fast giver --> slow taker.
struct Pair {
  explicit Pair(std::uint64_t synchroniser = 0, std::size_t giver_partition = 0, int numbers = 1)
      : machine_(synchroniser),
        giver(machine_.unit({.name = "giver", .clock = Clock(2), .partition = giver_partition, .sram_bytes = 64})),
        taker(machine_.unit({.name = "taker", .clock = Clock(10), .sram_bytes = 1024, .cache_bytes = 256})),
        link(machine_.link<int>(4, 3, giver, taker)),
        expected(static_cast<std::uint64_t>(numbers)) {
    taking = &machine_.build<Relay>(taker, Clock(10), &link, nullptr);
    machine_.build<Relay>(giver, Clock(2), nullptr, &link, numbers);
  }
  Machine& machine() { return machine_; }
  bool done() const { return taking->stats().taken == expected; }

  Machine machine_;
  UnitId giver, taker;
  Link<int>& link;
  std::uint64_t expected;
  Relay* taking = nullptr;
};

TEST(Machine, ALinkBetweenTwoClocksHasASynchroniserOfTheConsumers) {
  EXPECT_EQ(Pair(0).link.latency(), 3U * 2);
  EXPECT_EQ(Pair(2).link.latency(), 3U * 2 + 2 * 10);
  Pair pair(2);
  run(pair);
  EXPECT_EQ(pair.taking->last, 30U) << "26, at the consumer's next edge";
}

TEST(Machine, ALinkWithinAClockHasNone) {
  Machine machine(2);
  const UnitId a = machine.unit({.name = "a", .clock = Clock(2)}), b = machine.unit({.name = "b", .clock = Clock(2)});
  EXPECT_EQ(machine.link<int>(1, 3, a, b).latency(), 3U * 2);
}

TEST(Machine, UnitsAreReportedInTheOrderInWhichTheyAreBuilt) {
  Pair pair;
  const Time end = run(pair);
  pair.machine().finish(end + 1);
  const std::vector<UnitReport> report = pair.machine().report();
  ASSERT_EQ(report.size(), 2U);
  EXPECT_EQ(report[0].path, "taker");
  EXPECT_EQ(report[0].block, "far");
  EXPECT_EQ(report[0].sram_bytes, 1024U);
  EXPECT_EQ(report[0].cache_bytes, 256U);
  EXPECT_EQ(report[0].counters.front().value, 1U);
  EXPECT_EQ(report[0].elapsed, 2U) << "11 femtoseconds, at its next edge";
  EXPECT_EQ(report[1].path, "giver");
  EXPECT_EQ(report[1].cache_bytes, 64U) << "all of its storage";
  EXPECT_EQ(report[1].elapsed, 6U);
}

TEST(Machine, IsDrainedWhenUnitsAreIdleAndLinksEmpty) {
  Pair pair;
  EXPECT_FALSE(pair.machine().is_drained()) << "a number has not left yet";
  run(pair);
  EXPECT_TRUE(pair.machine().is_drained());
  pair.link.push(1000, 7);
  EXPECT_FALSE(pair.machine().is_drained());
}

TEST(Machine, StateHasALineForEachUnitThatHasOne) { EXPECT_EQ(Pair().machine().state(), "giver: has numbers\n"); }

TEST(Machine, LinksBetweenPartitionsBoundTheLookaheadAndAreCountedWhenNearlyFull) {
  Pair pair(2, 1, 100);
  pair.machine().start();
  EXPECT_EQ(pair.machine().min_lookahead(), 26U);
  ASSERT_EQ(pair.machine().partitions().outer.size(), 1U);
  const Partition& outer = pair.machine().partitions().outer.front();
  EXPECT_EQ(outer.nearly_full, 0U);
  for (int i = 0; i < 3; ++i) pair.link.push(0, i);
  EXPECT_EQ(outer.nearly_full, 1U);
  EXPECT_EQ(pair.machine().partitions().inner.nearly_full, 0U);
}

TEST(Machine, ALinkIsNearlyFullWhereOneTickOfItsProducerMightFillIt) {
  Machine machine;
  const UnitId inner = machine.unit({.name = "inner", .clock = Clock(2)});
  const UnitId outer = machine.unit({.name = "outer", .clock = Clock(2), .partition = 1});
  auto& two_at_once = machine.link<int>(4, 1, inner, outer, Lookahead::kByLatency, 2);
  auto& all_at_once = machine.link<int>(4, 1, outer, inner, Lookahead::kByLatency, 9);
  machine.build<Relay>(inner, Clock(2), &all_at_once, &two_at_once);
  machine.build<Relay>(outer, Clock(2), &two_at_once, &all_at_once);
  machine.start();
  EXPECT_EQ(machine.partitions().inner.nearly_full, 0U);
  for (int i = 0; i < 2; ++i) two_at_once.push(0, i);
  EXPECT_EQ(machine.partitions().inner.nearly_full, 1U);
  two_at_once.pop(2);
  EXPECT_EQ(machine.partitions().inner.nearly_full, 0U);
  EXPECT_EQ(machine.partitions().outer.front().nearly_full, 1U) << "from the start";
  all_at_once.push(0, 7);
  all_at_once.pop(2);
  EXPECT_EQ(machine.partitions().outer.front().nearly_full, 1U);
}

TEST(Machine, LinksByOwnerDoNotBoundTheLookahead) {
  Machine machine;
  const UnitId inner = machine.unit({.name = "inner", .clock = Clock(2)});
  const UnitId outer = machine.unit({.name = "outer", .clock = Clock(2), .partition = 1});
  auto& known = machine.link<int>(4, 1, inner, outer, Lookahead::kByOwner);
  auto& other = machine.link<int>(4, 9, outer, inner);
  machine.build<Relay>(inner, Clock(2), &other, &known);
  machine.build<Relay>(outer, Clock(2), &known, &other);
  machine.start();
  EXPECT_EQ(machine.min_lookahead(), 18U);
}

TEST(Machine, PartitionsShareNoGroupOfWakeUpTimes) {
  Pair pair(0, 1);
  pair.machine().start();
  const Partitions& partitions = pair.machine().partitions();
  EXPECT_LE(partitions.outer.front().units.end, partitions.inner.units.first);
  EXPECT_EQ(pair.machine().wake_time(pair.giver), 0U);
  EXPECT_EQ(pair.machine().wake_time(pair.taker), 0U);
}

/// A machine: giver --> sorter (a cluster) --> slow porter, all in one outer partition --> slower taker.
struct Chain {
  explicit Chain(int numbers) : expected(static_cast<std::uint64_t>(numbers)) {
    giving = &machine_.build<Relay>(giver, Clock(2), nullptr, &given, numbers);
    sorting = &machine_.build<Relay>(sorter, Clock(2), &given, &sorted);
    porting = &machine_.build<Relay>(porter, Clock(6), &sorted, &ported);
    taking = &machine_.build<Relay>(taker, Clock(10), &ported, nullptr);
    machine_.set_cluster({giver, sorter}, *this);
  }
  Machine& machine() { return machine_; }
  bool done() const { return taking->stats().taken == expected; }
  /// Returns the current time near the end, because the run may finish at any time.
  RunLimits run_limits(Time now) const {
    const Time end = taking->stats().taken + 8 >= expected ? now : now + machine_.min_lookahead();
    return {end, end};
  }
  void run(const ClusterTurn& turn, Time now) {
    turns += 1;
    do {
      cycles += 1;
      EXPECT_LT(now, run_limit(turn.partition, turn.inner, turn.end));
      for (const Time other : turn.others) EXPECT_LE(now, other) << "the porter had something to do before";
      if (turn.wakeup_times[0] <= now) turn.wakeup_times[0] = giving->tick(now);
      if (turn.wakeup_times[1] <= now) turn.wakeup_times[1] = sorting->tick(now);
      now = WakeupTable::refresh_group_minima(turn.wakeup_times, turn.group_minima);
    } while (turn.includes_time(now));
  }
  std::array<std::uint64_t, 8> outcome() const {
    return {giving->stats().taken, sorting->stats().taken, porting->stats().taken, taking->stats().taken,
            giving->last,          sorting->last,          porting->last,          taking->last};
  }

  Machine machine_{2};
  UnitId porter = machine_.unit({.name = "porter", .clock = Clock(6), .partition = 1});
  UnitId giver = machine_.unit({.name = "giver", .clock = Clock(2), .partition = 1});
  UnitId sorter = machine_.unit({.name = "sorter", .clock = Clock(2), .partition = 1});
  UnitId taker = machine_.unit({.name = "taker", .clock = Clock(10)});
  Link<int>& given = machine_.link<int>(3, 1, giver, sorter);
  Link<int>& sorted = machine_.link<int>(5, 2, sorter, porter);
  Link<int>& ported = machine_.link<int>(4, 3, porter, taker);
  std::uint64_t expected, turns = 0, cycles = 0;
  Relay *giving = nullptr, *sorting = nullptr, *porting = nullptr, *taking = nullptr;
};

TEST(Machine, AClusterThatRunsAloneChangesNothing) {
  Chain fast(200), oracle(200), shuffled(200);
  const Time end = run(fast);
  EXPECT_EQ(run<Skip::kOff>(oracle), end);
  EXPECT_EQ(run_shuffled(shuffled, 1), end);
  EXPECT_EQ(fast.outcome(), oracle.outcome());
  EXPECT_EQ(shuffled.outcome(), oracle.outcome());
  EXPECT_GT(fast.turns, 0U);
  EXPECT_GT(fast.cycles, fast.turns) << "it goes on for several cycles a turn";
  EXPECT_EQ(oracle.turns + shuffled.turns, 0U) << "where every unit is visited there are no clusters";
}

TEST(Machine, ThrowsForAnInvalidCluster) {
  Machine machine;
  const UnitId inner = machine.unit({.name = "inner", .clock = Clock(2)});
  const UnitId slow = machine.unit({.name = "slow", .clock = Clock(4), .partition = 1});
  const UnitId fast = machine.unit({.name = "fast", .clock = Clock(2), .partition = 1});
  Chain owner(1);
  EXPECT_THROW(machine.set_cluster({}, owner), std::logic_error);
  EXPECT_THROW(machine.set_cluster({inner}, owner), std::logic_error) << "partitions run around the inner one";
  EXPECT_THROW(machine.set_cluster({slow, fast}, owner), std::logic_error) << "two clocks";
  machine.set_cluster({slow}, owner);
  EXPECT_THROW(machine.set_cluster({fast}, owner), std::logic_error) << "the partition's second";
}

TEST(Machine, ThrowsForAUnitThatIsNotBuilt) {
  Machine machine;
  machine.unit({.name = "forgotten", .clock = Clock(2)});
  EXPECT_THROW(machine.start(), std::logic_error);
}

TEST(Machine, ThrowsForAUnitThatIsBuiltTwiceOrNotDeclared) {
  Machine machine;
  const UnitId unit = machine.unit({.name = "unit", .clock = Clock(2)});
  machine.build<Relay>(unit, Clock(2), nullptr, nullptr);
  EXPECT_THROW(machine.build<Relay>(unit, Clock(2), nullptr, nullptr), std::logic_error);
  EXPECT_THROW(machine.build<Relay>(UnitId{1, Clock(2)}, Clock(2), nullptr, nullptr), std::logic_error);
}

TEST(Machine, ThrowsForALinkOfAUnitThatIsNotDeclared) {
  Machine machine;
  const UnitId unit = machine.unit({.name = "unit", .clock = Clock(2)});
  EXPECT_THROW(machine.link<int>(1, 1, unit, UnitId{1, Clock(2)}), std::logic_error);
}

TEST(Machine, ThrowsForChangesAfterTheStart) {
  Pair pair;
  pair.machine().start();
  EXPECT_THROW(pair.machine().unit({.name = "late", .clock = Clock(2)}), std::logic_error);
  EXPECT_THROW(pair.machine().link<int>(1, 1, pair.giver, pair.taker), std::logic_error);
}

TEST(Machine, ThrowsForALinkBetweenTwoOuterPartitions) {
  Machine machine;
  const UnitId first = machine.unit({.name = "first", .clock = Clock(2), .partition = 1});
  const UnitId second = machine.unit({.name = "second", .clock = Clock(2), .partition = 2});
  auto& link = machine.link<int>(4, 1, first, second);
  machine.build<Relay>(first, Clock(2), nullptr, &link);
  machine.build<Relay>(second, Clock(2), &link, nullptr);
  EXPECT_THROW(machine.start(), std::logic_error);
}

}  // namespace
}  // namespace sim::test
