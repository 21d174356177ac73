#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/tools/studies/sweep/results/made_sweep.h"
#include "tools/studies/sweep/results/results.h"

// Tests of conditions, as in `raywatt sweep table --where`.

namespace test {
namespace {

using tools::results::Results;

/// A sweep of points 0 to 3 with sizes of 4, 8, 16 and 32 KiB and cycles of 400, 300, 200 and none.
struct FourKinds : MadeSweep {
  FourKinds() {
    const char* kinds[] = {"none", "2", "rau", "4"};
    for (std::size_t i = 0; i < 4; ++i) add({{"l1.size", std::to_string(4 << i) + " KiB"}, {"kind", kinds[i]}});
    for (std::size_t i = 0; i < 3; ++i) finish(i, 400 - 100.0 * static_cast<double>(i));
  }
};

std::string met(const std::vector<std::string>& conditions) {
  static const FourKinds sweep;
  static const Results results = sweep.results();
  std::string points;
  const std::vector<bool> all = rows_meeting(results, conditions);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i]) points += std::to_string(i);
  }
  return points;
}

std::string refusal(const std::string& condition) {
  try {
    met({condition});
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return "it is allowed";
}

TEST(Condition, ComparesNumbers) {
  EXPECT_EQ(met({"cycles<300"}), "2");
  EXPECT_EQ(met({"cycles<=300"}), "12");
  EXPECT_EQ(met({"cycles=300"}), "1");
  EXPECT_EQ(met({"cycles == 3e2"}), "1");
  EXPECT_EQ(met({"cycles!=300"}), "02");
  EXPECT_EQ(met({"totals.cycles >= 300"}), "01");
  EXPECT_EQ(met({"  cycles > 300  "}), "0");
  EXPECT_EQ(met({"cycles>-1.5"}), "012");
}

TEST(Condition, APointWithoutTheValueNeverMeetsIt) {
  EXPECT_EQ(met({"cycles!=1"}), "012");
  EXPECT_EQ(met({"cycles<1e9"}), "012");
}

TEST(Condition, ComparesQuantitiesByWhatTheyAre) {
  EXPECT_EQ(met({"l1.size>=16 KiB"}), "23");
  EXPECT_EQ(met({"l1.size<'8 KiB'"}), "0");
  EXPECT_EQ(met({"size=8192 B"}), "1");
  EXPECT_EQ(met({"size=8KiB"}), "1");
}

TEST(Condition, ComparesTextsForEquality) {
  EXPECT_EQ(met({"kind=rau"}), "2");
  EXPECT_EQ(met({"kind!=\"rau\""}), "013");
  EXPECT_EQ(met({"status=missing"}), "3");
  EXPECT_EQ(met({"totals.limiter='L2, and \"DRAM\"'"}), "012");
  EXPECT_EQ(met({"kind>2"}), "3") << "texts beside numbers are not above any";
}

TEST(Condition, AMetricWithABandDenotesItsNominalValue) {
  EXPECT_EQ(met({"power_w>=0"}), met({"power_w.nominal>=0"}));
  EXPECT_EQ(met({"power_w<0"}), "");
}

TEST(Condition, AllMustHold) {
  EXPECT_EQ(met({"cycles<400 and l1.size<16 KiB"}), "1");
  EXPECT_EQ(met({"cycles<400", "l1.size<16 KiB"}), "1");
  EXPECT_EQ(met({"cycles<400 and kind=2 and n=1"}), "1");
  EXPECT_EQ(met({}), "0123");
}

TEST(Condition, SaysAtWhichColumnItIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {{"", "column 1"},
                                                       {"<1", "column 1"},
                                                       {"cycles", "column 7"},
                                                       {"cycles<", "column 8"},
                                                       {"cycles<1 or n=1", "column 10"},
                                                       {"cycles<1 and", "column 13"},
                                                       {"cycles<1 andn=1", "column 10"},
                                                       {"cycles='a", "column 8"},
                                                       {"cycles ~ 1", "column 8"}};
  for (const auto& [condition, column] : wrong) EXPECT_SAYS(refusal(condition), column);
}

TEST(Condition, RefusesWhatCannotBeCompared) {
  EXPECT_SAYS(refusal("l1.size<16"), "'4 KiB'");
  EXPECT_SAYS(refusal("l1.size<16 MHz"), "'4 KiB'");
  EXPECT_SAYS(refusal("cycles<fast"), "'fast' is no number");
  EXPECT_SAYS(refusal("limiter<3"), "texts are compared with = and !=");
  EXPECT_SAYS(refusal("cylces<3"), "did you mean 'cycles'");
}

TEST(Condition, SaysThatAUnitOrOrIsNotKnown) {
  EXPECT_SAYS(refusal("cycles<=12mm2"), "'mm2' of '12mm2' is no unit of frequency, time or bytes");
  EXPECT_SAYS(refusal("cycles<=12 mm2"), "'mm2' after '12' is no unit of frequency, time or bytes");
  EXPECT_SAYS(refusal("cycles<300 or cycles>400"), "'or' is not known");
  EXPECT_SAYS(refusal("kind=rau cycles<3"), "'and' is missing");
}

}  // namespace
}  // namespace test
