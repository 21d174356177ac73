#include "hw_models/srp/srp_config.h"

#include <string>

#include <gtest/gtest.h>

namespace hw::test {
namespace {

std::string complaints(const ArrayConfig& array) {
  std::string keys;
  array.check([&](const std::string& key, const std::string&) { keys += key + ' '; });
  return keys;
}

TEST(SrpConfig, AUnitCannotHaveTwoMultipliersOrDividers) {
  EXPECT_EQ(complaints({}), "");
  EXPECT_EQ(complaints({.rows = 4, .columns = 2}), "mul_units ");
  EXPECT_EQ(complaints({.rows = 1, .columns = 2, .mul_units = 2, .div_sqrt_units = 3}), "div_sqrt_units ");
  EXPECT_EQ(complaints({.rows = 1, .columns = 2, .mul_units = 2, .div_sqrt_units = 2}), "");
}

TEST(SrpConfig, ALoadTakesAtMostSixtyFourCycles) {
  const auto complaints_of = [](const OpLatencyConfig& latency) {
    std::string keys;
    latency.check([&](const std::string& key, const std::string&) { keys += key; });
    return keys;
  };
  EXPECT_EQ(complaints_of({.cached_load = 4, .load_queue = 60}), "");
  EXPECT_EQ(complaints_of({.cached_load = 5, .load_queue = 60}), "load_queue");
}

TEST(SrpConfig, ItsStorageExcludesTheTileBuffer) { EXPECT_EQ(SrpConfig{}.sram_bytes(), (16U + 64U + 36U) * 1024U); }

}  // namespace
}  // namespace hw::test
