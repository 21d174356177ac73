#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/studies/report/diff/diff_parts.h"

// Words and rows of the page of two runs.

namespace tools::pages {
namespace {

/// First column of a waterfall between two totals.
std::vector<std::string> parts_between(double a, const std::vector<Pair>& changes, double b) {
  std::vector<std::string> names;
  const Json data = waterfall("before", a, changes, "after", b, "").json();
  for (const Json& row : data["rows"]) names.push_back(row[0].get<std::string>());
  return names;
}

TEST(Waterfalls, NameTheOnlySmallPartAndCountSeveral) {
  const std::vector<Pair> one = {{"switches", 0, 100}, {"banks", 1, 0}};
  EXPECT_EQ(parts_between(1000, one, 1099), (std::vector<std::string>{"before", "switches", "banks", "after"}));
  const std::vector<Pair> two = {{"switches", 0, 100}, {"banks", 1, 0}, {"transfers", 1, 0}};
  EXPECT_EQ(parts_between(1000, two, 1098), (std::vector<std::string>{"before", "switches", "2 others", "after"}));
}

TEST(CountsOnPages, AreSingularForOneAlone) {
  EXPECT_EQ(counted(1, "core"), "1 core");
  EXPECT_EQ(counted(0, "light"), "0 lights");
  EXPECT_EQ(counted(4, "traversal unit"), "4 traversal units");
  EXPECT_EQ(counted(31'900, "triangle"), "31.9 k triangles");
}

/// Verdict on cycles and energy that a run has 2 % less of than the other.
Json verdict(const NoisyDifference& of_cycles, const NoisyDifference& of_energy) {
  Comparison found;
  found.no_picture = "there are none";
  found.figures = {{"cycles", 100, 98, of_cycles}, {"energy_mj", 100, 98, of_energy}};
  const ReportFile none{};
  View view("page");
  add_diff_verdict({none, none, "base", "other", found}, view);
  return view.json()["verdict"];
}

TEST(DiffVerdict, SaysOfCyclesAndOfEnergyWhetherTheNoiseExplainsThem) {
  const NoisyDifference outside{.relative = -0.02, .half_width = 0.01, .outside = true};
  const NoisyDifference within{.relative = -0.02, .half_width = 0.03, .measured = true};
  const Json mixed = verdict(outside, within);
  EXPECT_EQ(mixed["sentence"], "other takes 2.0 % fewer cycles than base, which is outside the noise.");
  EXPECT_EQ(mixed["more"], "Energy −2.0 %, which is within the noise. The pictures are not compared: there are none.");
  const Json other = verdict(within, outside);
  EXPECT_EQ(other["sentence"], "other takes 2.0 % fewer cycles than base, which is within the noise.");
  EXPECT_EQ(other["more"], "Energy −2.0 %, which is outside the noise. The pictures are not compared: there are none.");
}

}  // namespace
}  // namespace tools::pages
