#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tools/studies/sweep/spec/plan.h"

// Tests of the combinations that a sweep simulates if it does not simulate all.

namespace test {
namespace {

using tools::sweep::Choice;
using tools::sweep::Subset;

const std::vector<std::uint32_t> kAxisSizes = {8, 5, 16};

bool everything(const Choice&) { return true; }

std::vector<Choice> chosen(Subset::Kind kind, std::uint64_t count, std::uint64_t seed = 1,
                           const std::function<bool(const Choice&)>& is_wanted = everything) {
  return tools::sweep::choose_combinations({kind, count, seed}, kAxisSizes, is_wanted);
}

/// Counts how often each value of an axis was drawn.
std::vector<int> counts_of(const std::vector<Choice>& choices, std::size_t axis) {
  std::vector<int> counts(kAxisSizes[axis]);
  for (const Choice& choice : choices) counts.at(choice.at(axis)) += 1;
  return counts;
}

TEST(Subset, OfTheGridIsAllOfIt) {
  const std::vector<Choice> all = chosen(Subset::Kind::kGrid, 0);
  EXPECT_EQ(all.size(), 640U);
  EXPECT_TRUE(std::ranges::is_sorted(all));
  EXPECT_EQ(chosen(Subset::Kind::kGrid, 0, 1, [](const Choice& c) { return c[0] == 2; }).size(), 80U);
}

TEST(Subset, IsTheSameForASeedAndHasNoPointTwice) {
  for (const auto kind : {Subset::Kind::kRandom, Subset::Kind::kLatinHypercube, Subset::Kind::kSobol}) {
    const std::vector<Choice> points = chosen(kind, 100);
    EXPECT_EQ(points, chosen(kind, 100));
    EXPECT_NE(points, chosen(kind, 100, 2));
    EXPECT_EQ(std::set<Choice>(points.begin(), points.end()).size(), points.size());
  }
}

TEST(Subset, OfRandomAndSobolHasTheWantedSizeWhateverIsExcluded) {
  const auto half = [](const Choice& c) { return c[0] < 4; };
  for (const auto kind : {Subset::Kind::kRandom, Subset::Kind::kSobol}) {
    const std::vector<Choice> points = chosen(kind, 100, 1, half);
    EXPECT_EQ(points.size(), 100U);
    EXPECT_TRUE(std::ranges::all_of(points, half));
    EXPECT_EQ(chosen(kind, 640).size(), 640U) << "as many as there are";
    EXPECT_EQ(chosen(kind, 10'000).size(), 640U) << "more than there are";
  }
}

TEST(Subset, GrowsByAppending) {
  for (const auto kind : {Subset::Kind::kRandom, Subset::Kind::kSobol}) {
    const std::vector<Choice> few = chosen(kind, 20), more = chosen(kind, 40);
    EXPECT_TRUE(std::ranges::equal(few, std::span(more).first(20)));
  }
}

TEST(Subset, OfALatinHypercubeDrawsEachValueOfAnAxisEquallyOften) {
  const std::vector<Choice> points = chosen(Subset::Kind::kLatinHypercube, 80);
  ASSERT_GE(points.size(), 70U);
  const int dropped = 80 - static_cast<int>(points.size());
  for (std::size_t axis = 0; axis < kAxisSizes.size(); ++axis) {
    for (const int count : counts_of(points, axis)) {
      EXPECT_LE(count, 80 / static_cast<int>(kAxisSizes[axis]));
      EXPECT_GE(count, 80 / static_cast<int>(kAxisSizes[axis]) - dropped);
    }
  }
}

TEST(Subset, OfSobolIsEvenOnEveryAxis) {
  const std::vector<Choice> points =
      tools::sweep::choose_combinations({Subset::Kind::kSobol, 64, 7}, std::vector<std::uint32_t>{64, 64}, everything);
  std::set<std::uint32_t> columns, rows;
  for (const Choice& choice : points) {
    columns.insert(choice[0] / 2);
    rows.insert(choice[1] / 2);
  }
  EXPECT_EQ(columns.size(), 32U);
  EXPECT_EQ(rows.size(), 32U);
}

TEST(Subset, ThatIsTooLargeIsRefusedBeforeItTakesAllMemory) {
  const std::vector<std::uint32_t> huge(60, 10'000);
  EXPECT_THROW(tools::sweep::choose_combinations({}, huge, everything), sim::InputError);
  EXPECT_EQ(tools::sweep::choose_combinations({Subset::Kind::kSobol, 50, 1}, huge, everything).size(), 50U);
  EXPECT_TRUE(tools::sweep::choose_combinations({Subset::Kind::kRandom, 50, 1}, huge, [](const Choice&) {
                return false;
              }).empty());
}

}  // namespace
}  // namespace test
