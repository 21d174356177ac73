#include "tools/analysis/units.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "hw_models/frame/memory_interface.h"
#include "tests/tools/analysis/made_up_machine.h"

// Tests of reading counters and cycle reasons of units by their declarations.

namespace tools {
namespace {

using TrvStats = hw::Trv::Stats;

TEST(Units, SumWhatThoseOfOneTypeReport) {
  std::vector<sim::UnitReport> units = test::SyntheticMachine{
      .trv = {{"visiting", 30}, {"l1_miss", 70}},
      .of_trv = {{"visits", 30},
                 {"l1_hits", 5}}}.units();
  units.push_back(units.front());
  units.back().path = "core1.tni.trv0";
  const Units<hw::Trv> all(units), second(units, "core1.");
  EXPECT_EQ(all.elapsed(), 200U);
  EXPECT_EQ(all.sum_of(&TrvStats::visits), 60U);
  EXPECT_EQ(all.sum_of(&TrvStats::l1_hits), 10U) << "declared by what Stats derives from";
  EXPECT_EQ(all.spent(hw::Trv::CycleReason::kL1Miss), 140U);
  EXPECT_DOUBLE_EQ(all.share(hw::Trv::CycleReason::kVisiting), 0.3);
  EXPECT_EQ(second.sum_of(&TrvStats::visits), 30U);
}

TEST(Units, ThatAMachineDoesNotHaveCountNothing) {
  const std::vector<sim::UnitReport> units = test::SyntheticMachine{}.units();
  const Units<hw::MemoryInterface> none(units);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.sum_of(&hw::MemoryInterface::Stats::rays), 0U);
}

TEST(Units, ThrowAtACounterThatIsNotDeclaredOrNotReported) {
  std::vector<sim::UnitReport> units = test::SyntheticMachine{}.units();
  static const std::uint64_t elsewhere = 0;
  const auto undeclared = [](const TrvStats&) -> const std::uint64_t& { return elsewhere; };
  EXPECT_THROW(Units<hw::Trv>(units).sum_of(undeclared), std::logic_error);
  std::erase_if(units.front().counters, [](const sim::CounterReport& counter) { return counter.name == "visits"; });
  EXPECT_THROW(Units<hw::Trv>(units).sum_of(&TrvStats::visits), std::logic_error);
}

TEST(Units, ThrowAtAReasonThatIsNotReported) {
  std::vector<sim::UnitReport> units = test::SyntheticMachine{}.units();
  units.front().cycles_by_reason.clear();
  EXPECT_THROW(Units<hw::Trv>(units).spent(hw::Trv::CycleReason::kVisiting), std::out_of_range);
}

}  // namespace
}  // namespace tools
