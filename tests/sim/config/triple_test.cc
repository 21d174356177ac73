#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/named.h"

namespace sim {
namespace {

struct Config {
  Triple colour{0.5, 1, 0};
  static void describe(auto& c, auto&& field) {
    field(NAMED(c.colour), "", "linear RGB", between(0, 1), Affects::kFunction);
  }
};

Config with(const std::string& value) {
  Config config;
  const std::vector<std::string> sets = {"colour=" + value};
  apply_sets(config, sets);
  return config;
}

std::string refusal(const std::string& value) {
  try {
    with(value);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Triple, IsThreeNumbersInOneText) {
  EXPECT_EQ(with("0.25 0 1e-3").colour, (Triple{0.25, 0, 1e-3}));
  EXPECT_EQ(with("  1   1  1 ").colour, (Triple{1, 1, 1}));
}

TEST(Triple, IsDumpedAsItIsRead) {
  EXPECT_EQ(config_json(with("0.25 0 1"))["colour"], "0.25 0 1");
  EXPECT_NE(dump_config(with("0.25 0 1")).find("colour: 0.25 0 1  #"), std::string::npos);
}

TEST(Triple, RefusesWhatIsNotThreeNumbers) {
  for (const char* text : {"1 2", "1 2 3 4", "red", "1 x 0", "nan 0 0", ""}) {
    EXPECT_NE(refusal(text).find("is not three numbers"), std::string::npos) << text << ": " << refusal(text);
  }
}

TEST(Triple, KeepsItsLimitsInEveryNumber) {
  EXPECT_NE(refusal("0 0 1.5").find("'1.5' is out of range; allowed: three numbers, each 0 to 1"), std::string::npos)
      << refusal("0 0 1.5");
}

}  // namespace
}  // namespace sim
