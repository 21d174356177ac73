#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/validation/figures.h"

// Compares undersampling with Kim et al. 2016, tables 3 to 5. DEVIATIONS.md explains the differences.

namespace tools::reproduce {
namespace {

using Figures = std::map<std::string, double>;

TEST(Kim2016, TracesLessWithMorePixelsAndGainsTimeLaterAsInterpolatedSamplesTakeMoreOperations) {
  const std::vector<Case> cases = kim_cases(false);
  const Figures coarse = measure(cases, "conference", "1024 1x1", 128);
  Figures fine = measure(cases, "conference", "1024 1x1", 256);
  const auto falls = [&](const char* figure) { return fine[figure] < coarse.at(figure); };
  expect_between("traced ratio, published 0.300 of 1024x1024", fine["traced_ratio"], 0.5, 0.65);
  EXPECT_TRUE(falls("traced_ratio"));
  expect_between("speed-up, published 1.65 of 1024x1024", fine["speedup"], 0.55, 0.8);
  EXPECT_FALSE(falls("speedup"));
  expect_between("operations of a traced sample", fine["ops_of_traced"], 450, 600);
  EXPECT_GT(fine["ops_of_interpolated"], fine["ops_of_traced"]) << "shader cores have no traversal to spare";
  EXPECT_TRUE(falls("ops_of_interpolated")) << "halos are smaller parts of larger pictures";
  expect_between("share of checks and interpolation, published 0.163", fine["adaptive_share"], 0.1, 0.2);
}

}  // namespace
}  // namespace tools::reproduce
