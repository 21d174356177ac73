#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/studies/optimise/surrogate.h"

namespace test {
namespace {

using namespace tools::optimise;

TEST(Acquisition, ComputesTheNormalDistribution) {
  EXPECT_DOUBLE_EQ(log_normal_cdf(0), std::log(0.5));
  EXPECT_NEAR(log_normal_cdf(1.959963984540054), std::log(0.975), 1e-14);
  EXPECT_NEAR(log_normal_cdf(-1.959963984540054), std::log(0.025), 1e-13);
  EXPECT_NEAR(log_normal_cdf(-40), -804.6084420137538, 1e-5);  // Johnson and others: -z^2/2 - log(z sqrt(2 pi)) - ...
}

TEST(Acquisition, IsFiniteIfProbabilitiesUnderflow) {
  for (const double z : {-29.9, -30.1, -38.0, -100.0, -1000.0}) {
    EXPECT_GT(log_normal_cdf(z), log_normal_cdf(z - 0.1)) << z;
    EXPECT_GT(log_expected_gain({z, 1}, 0), log_expected_gain({z - 0.1, 1}, 0)) << z;
    EXPECT_TRUE(std::isfinite(log_expected_gain({z, 1}, 0))) << z;
  }
}

TEST(Acquisition, ExpectsTheMeanGainAboveTheBest) {
  // A normal value at the best one, and far above it.
  EXPECT_NEAR(log_expected_gain({3, 2}, 3), std::log(2 / std::sqrt(2 * std::numbers::pi)), 1e-14);
  EXPECT_NEAR(log_expected_gain({103, 2}, 3), std::log(100), 1e-14);
  EXPECT_NEAR(std::exp(log_expected_gain({2, 1}, 3)), 0.08331547058768617, 1e-14);  // phi(1) - (1 - Phi(1))
}

TEST(Acquisition, IsExactForExactValues) {
  EXPECT_DOUBLE_EQ(log_expected_gain({5, 0}, 3), std::log(2));
  EXPECT_EQ(log_expected_gain({3, 0}, 3), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(log_probability({5, 0}, 3, true), 0);
  EXPECT_EQ(log_probability({5, 0}, 3, false), -std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(log_probability({5, 1}, 5, true), std::log(0.5));
}

}  // namespace
}  // namespace test
