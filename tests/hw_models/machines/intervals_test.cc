#include "sim/intervals.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/full_size.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"

// Tests of machines whose counters are recorded at the ends of intervals.

namespace hw {
namespace {

using sim::Intervals;
using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
using test::play;

/// Interval lengths whose ends are edges of no clock, or of several clocks.
constexpr sim::Time kOddLength = 61'234'567, kEvenLength = 100 * sim::kFemtosecondsPerNanosecond;

/// Returns the first difference between two recordings of intervals; empty if they are equal.
std::string difference(const Intervals& a, const Intervals& b) {
  if (a.size() != b.size() || a.row_width() != b.row_width() || a.interval_length() != b.interval_length() ||
      a.end() != b.end()) {
    return fmt::format("{} x {} of {} to {}, {} x {} of {} to {}", a.size(), a.row_width(), a.interval_length(),
                       a.end(), b.size(), b.row_width(), b.interval_length(), b.end());
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto [x, y] = std::ranges::mismatch(a.row(i), b.row(i));
    if (x != a.row(i).end()) return fmt::format("interval {}, value {}: {}, {}", i, x - a.row(i).begin(), *x, *y);
  }
  return {};
}

/// Checks a recording: the last row equals the units' reports, values never decrease, and reasons fill each interval.
void expect_sums(const Intervals& intervals, const Outcome& run) {
  ASSERT_GT(intervals.size(), 0U);
  EXPECT_EQ(intervals.end(), run.elapsed);
  std::size_t value = 0;
  for (const sim::UnitReport& unit : run.units) {
    const std::size_t first = value;
    for (const auto& [reason, cycles] : unit.cycles_by_reason) {
      EXPECT_EQ(intervals.row(intervals.size() - 1)[value++], cycles) << unit.path << ' ' << reason;
    }
    const std::size_t reasons = value;
    for (const sim::CounterReport& counter : unit.counters) {
      EXPECT_EQ(intervals.row(intervals.size() - 1)[value++], counter.value) << unit.path << ' ' << counter.name;
    }
    std::uint64_t cycles_before = 0;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      std::uint64_t cycles = 0;
      for (std::size_t v = first; v < reasons; ++v) cycles += intervals.row(i)[v];
      EXPECT_GE(cycles, cycles_before) << unit.path << ' ' << i;
      cycles_before = cycles;
      for (std::size_t v = first; i != 0 && v < value; ++v) {
        ASSERT_GE(intervals.row(i)[v], intervals.row(i - 1)[v]) << unit.path << " value " << v - first << ", " << i;
      }
    }
  }
  EXPECT_EQ(value, intervals.row_width());
}

TEST(Intervals, AddUpToEveryCounterAndReasonAndChangeNone) {
  const GpuConfig config;
  Intervals intervals(kEvenLength);
  const Outcome plain = play(test::teapot_64x32(), config), recorded = play(test::teapot_64x32(), config, intervals);
  EXPECT_EQ(difference(plain, recorded), "");
  EXPECT_EQ(hw::test::difference(plain.function, recorded.function), "");
  expect_sums(intervals, recorded);
  EXPECT_GT(intervals.size(), 50U);
}

TEST(Intervals, HaveOfEachUnitTheCyclesThatBeginInThem) {
  const GpuConfig config;
  Intervals intervals(kOddLength);
  const Outcome run = play(test::cornell_64x32(), config, intervals);
  const sim::Clock tni = config.clocks.tni.clock(), dram(config.dram.timing.ck.time);
  std::size_t value = 0;
  for (const sim::UnitReport& unit : run.units) {
    const bool is_tni = unit.path.ends_with("tni.ist"), is_dram = unit.path.starts_with("dram.");
    for (std::size_t i = 0; (is_tni || is_dram) && i < intervals.size(); ++i) {
      std::uint64_t cycles = 0;
      for (std::size_t v = 0; v < unit.cycles_by_reason.size(); ++v) cycles += intervals.row(i)[value + v];
      const sim::Clock& clock = is_tni ? tni : dram;
      ASSERT_EQ(cycles, clock.cycles(clock.edge_at_or_after(intervals.interval_end(i)))) << unit.path << ' ' << i;
    }
    value += unit.cycles_by_reason.size() + unit.counters.size();
  }
}

/// Records intervals in every engine mode and with several numbers of threads, and expects equal recordings.
void expect_same_in_all_engines(const Frame& frame, const GpuConfig& config, std::uint64_t seed) {
  const Outcome plain = play(frame, config);
  Intervals fast(kOddLength, 512), oracle(kOddLength, 512), shuffled(kOddLength, 512), threaded(kOddLength, 512);
  const Outcome run = play(frame, config, fast);
  EXPECT_EQ(difference(plain, run), "");
  EXPECT_EQ(difference(plain, play(frame, config, oracle, Engine::kOracle)), "");
  EXPECT_EQ(difference(plain, play(frame, config, shuffled, Engine::kShuffled, seed)), "");
  EXPECT_EQ(difference(plain, play(frame, config, threaded, Engine::kFast, 0, 2)), "");
  EXPECT_EQ(difference(fast, oracle), "");
  EXPECT_EQ(difference(fast, shuffled), "");
  EXPECT_EQ(difference(fast, threaded), "");
  expect_sums(fast, run);
}

TEST(Intervals, AreTheSameInAllEnginesAndForAnyNumberOfThreads) {
  expect_same_in_all_engines(test::cornell_64x32(), {}, 1);
}

TEST(Intervals, AreTheSameInAllEnginesOnRandomMachinesToo) {
  static const Frame frame("cornell", 16, 16);
  for (std::uint64_t seed = 300; seed < ::test::full_or(306U, 302U); ++seed) {
    SCOPED_TRACE(seed);
    expect_same_in_all_engines(frame, test::random_config(seed), seed);
  }
}

TEST(Intervals, AreTheSameInAllEnginesWithRaysThroughMemoryAndMemoryThatPowersDown) {
  static const Frame frame("cornell", 32, 16);
  GpuConfig config;
  config.direct_interface.enabled = false;
  config.dram.controller.power_down = true;
  config.dram.controller.power_down_after = 16;
  expect_same_in_all_engines(frame, config, 2);
}

TEST(Intervals, MergeInPairsWhenThereAreTooMany) {
  const GpuConfig config;
  Intervals fine(kEvenLength), coarse(kEvenLength, 8);
  play(test::teapot_64x32(), config, fine);
  play(test::teapot_64x32(), config, coarse);
  EXPECT_LE(coarse.size(), 8U);
  EXPECT_GT(coarse.size(), 4U);
  const std::size_t merged = coarse.interval_length() / fine.interval_length();
  EXPECT_EQ(coarse.interval_length() % fine.interval_length(), 0U);
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const std::size_t last = std::min((i + 1) * merged, fine.size()) - 1;
    EXPECT_EQ(coarse.interval_end(i), fine.interval_end(last));
    EXPECT_TRUE(std::ranges::equal(coarse.row(i), fine.row(last))) << i;
  }
}

}  // namespace
}  // namespace hw
