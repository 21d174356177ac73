#include "sim/engine.h"

#include <gtest/gtest.h>

#include "pipeline.h"

namespace sim::test {
namespace {

/// Returns the configurations of a small pipeline in all combinations of clocks, depths and intervals.
std::vector<PipelineConfig> machines() {
  std::vector<PipelineConfig> all;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const auto draw = [&](std::uint64_t what, std::uint64_t most) { return 1 + hash(i, what) % most; };
    PipelineConfig c;
    c.source = Clock(draw(0, 7));
    c.stage = Clock(draw(1, 7));
    c.sink = Clock(draw(2, 7));
    c.capacity = draw(3, 4);
    c.latency = draw(4, 5);
    c.depth = draw(5, 9);
    c.in_flight = draw(6, 4);
    c.interval = draw(7, 12);
    all.push_back(c);
  }
  return all;
}

/// Results of a run: its end, the items with their arrival times, and each unit's time by reason.
struct Outcome {
  Time end = 0;
  std::vector<std::uint64_t> taken;
  std::vector<Time> times;
  std::vector<Time> spent;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

template <class Machine = Pipeline>
Outcome outcome(const PipelineConfig& c, auto&& engine) {
  Machine machine(c);
  const Time end = engine(machine);
  std::vector<Time> spent = machine.spent(end);
  return {end, machine.sink.taken, machine.sink.times, std::move(spent)};
}

TEST(Engine, ALoneItemTakesTheSumOfTheLatencies) {
  PipelineConfig c;
  c.items = 1;
  c.latency = 4;
  c.depth = 5;
  Pipeline machine(c);
  EXPECT_EQ(run(machine), 2U * (4 + 5 + 4));
}

TEST(Engine, ASlowSinkSetsThePace) {
  PipelineConfig c;
  c.interval = 9;
  Pipeline machine(c);
  run(machine);
  EXPECT_EQ(machine.sink.times.back() - machine.sink.times.front(), 2U * 9 * (c.items - 1));
}

TEST(Engine, TwoInFlightInAPipeOfThreeBoundThroughputToTwoPerFourCycles) {
  PipelineConfig c;
  Pipeline machine(c);
  run(machine);
  EXPECT_NEAR(static_cast<double>(machine.sink.times.back() - machine.sink.times.front()), 2 * 49 * 4 / 2.0, 4);
}

TEST(Engine, SkippingIdleTimeChangesNothing) {
  for (const PipelineConfig& c : machines()) {
    const Outcome skipping = outcome(c, [](Pipeline& m) { return run(m); });
    const Outcome oracle = outcome(c, [](Pipeline& m) { return run<Skip::kOff>(m); });
    ASSERT_EQ(skipping.end, oracle.end);
    ASSERT_EQ(skipping.times, oracle.times);
    ASSERT_EQ(skipping.spent, oracle.spent);
  }
}

TEST(Engine, TheOrderOfUnitsChangesNothing) {
  std::uint64_t seed = 0;
  for (const PipelineConfig& c : machines()) {
    const Outcome plain = outcome(c, [](Pipeline& m) { return run(m); });
    const Outcome shuffled = outcome(c, [&](Pipeline& m) { return run_shuffled(m, ++seed); });
    ASSERT_EQ(plain, shuffled);
  }
}

TEST(Engine, RunningPartitionsApartChangesNothing) {
  for (const PipelineConfig& c : machines()) {
    const Outcome together = outcome(c, [](Pipeline& m) { return run(m); });
    const Outcome apart = outcome<ApartPipeline>(c, [](ApartPipeline& m) { return run(m); });
    ASSERT_EQ(together, apart);
  }
}

TEST(Engine, EveryUnitsTimeSumsToTheWhole) {
  for (const PipelineConfig& c : machines()) {
    Pipeline machine(c);
    const Time end = run(machine);
    machine.spent(end);
    EXPECT_EQ(machine.stage.activity.accounted_until(), c.stage.edge_at_or_after(end + 1));
    Time sum = 0;
    for (std::size_t i = 0; i < machine.stage.activity.kReasons; ++i) {
      sum += machine.stage.activity.spent(static_cast<Stage::CycleReason>(i));
    }
    EXPECT_EQ(sum, machine.stage.activity.accounted_until());
  }
}

TEST(Engine, NothingIsLostOrReordered) {
  for (const PipelineConfig& c : machines()) {
    const Outcome o = outcome(c, [](Pipeline& m) { return run(m); });
    ASSERT_EQ(o.taken.size(), c.items);
    for (std::uint64_t i = 0; i < c.items; ++i) ASSERT_EQ(o.taken[i], c.items - i);
  }
}

TEST(Engine, AStuckMachineIsFoundWithItsState) {
  PipelineConfig c;
  c.appetite = 10;
  const auto state_of = [&](auto&& engine) {
    Pipeline machine(c);
    try {
      engine(machine);
    } catch (const Deadlock& stuck) {
      return stuck.state;
    }
    return std::string("not stuck");
  };
  const std::string stuck = "source: 2 in its link\nstage: 2 in its link\n";
  EXPECT_EQ(state_of([](Pipeline& m) { run(m); }), stuck);
  EXPECT_EQ(state_of([](Pipeline& m) { run<Skip::kOff>(m); }), stuck);
  EXPECT_EQ(state_of([](Pipeline& m) { run_shuffled(m, 1); }), stuck);
}

TEST(Engine, AMachineThatRetiresNothingIsInALivelock) {
  PipelineConfig c;
  c.appetite = 10;
  c.restless = true;
  c.source = c.stage = c.sink = Clock(kFemtosecondsPerNanosecond);
  c.livelock_timeout = 1000 * kFemtosecondsPerNanosecond;
  const auto complaint = [](auto&& machine, auto&& engine) {
    try {
      engine(machine);
    } catch (const Deadlock& stuck) {
      EXPECT_EQ(machine.sink.taken.size(), 10U);
      EXPECT_EQ(stuck.state, "source: 2 in its link\nstage: 2 in its link\n");
      return std::string(stuck.what());
    }
    return std::string("none");
  };
  const std::string livelock =
      "the machine is in a livelock: its units go on, and none has retired anything for 1000 ns, the time that its "
      "watchdog gives it";
  EXPECT_EQ(complaint(Pipeline(c), [](Pipeline& m) { run(m); }), livelock);
  EXPECT_EQ(complaint(Pipeline(c), [](Pipeline& m) { run<Skip::kOff>(m); }), livelock);
  EXPECT_EQ(complaint(Pipeline(c), [](Pipeline& m) { run_shuffled(m, 1); }), livelock);
  EXPECT_EQ(complaint(ApartPipeline(c), [](ApartPipeline& m) { run(m); }), livelock);
}

TEST(Engine, AMachineThatRetiresWithinItsTimeoutIsInNoLivelock) {
  PipelineConfig c;
  c.interval = 100;
  c.livelock_timeout = 2 * 100 + 2 * (1 + 3 + 1);  // one interval of the sink plus the latency of the link
  Pipeline machine(c);
  EXPECT_NO_THROW(run(machine));
  EXPECT_EQ(machine.sink.taken.size(), c.items);
}

TEST(Engine, PartitionsThatAreStuckAreFoundToo) {
  PipelineConfig c;
  c.appetite = 10;
  ApartPipeline machine(c);
  EXPECT_THROW(run(machine), Deadlock);
}

}  // namespace
}  // namespace sim::test
