#include "hw_models/tni/tni_config.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/error.h"

namespace hw {
namespace {

TEST(TniConfig, OnlyTheRestartTrailAndParentLinksWorkWithoutAStack) {
  TniConfig config;
  config.trv.stack_entries = 0;
  for (const StackScheme scheme : {StackScheme::kFull, StackScheme::kRestartLink}) {
    config.trv.stack = scheme;
    EXPECT_THROW(sim::check_config(config), sim::InputError);
  }
  for (const StackScheme scheme : {StackScheme::kRestartTrail, StackScheme::kParent}) {
    config.trv.stack = scheme;
    EXPECT_NO_THROW(sim::check_config(config));
  }
}

TEST(TniConfig, RefusesMoreIntersectionUnitsThanTraversalUnits) {
  TniConfig config;
  config.trvs = 2;
  config.ists = 2;
  EXPECT_NO_THROW(sim::check_config(config));
  config.ists = 3;
  try {
    sim::check_config(config);
    FAIL() << "accepted";
  } catch (const sim::InputError& error) {
    EXPECT_EQ(std::string(error.what()), "ists: is 3; allowed: 1 to tni.trvs, which is 2");
  }
}

std::uint32_t count_of(const std::vector<sim::UnitPart>& parts, const std::string& name) {
  for (const sim::UnitPart& part : parts) {
    if (part.name == name) return part.count;
  }
  ADD_FAILURE() << "no part " << name;
  return 0;
}

TEST(TniConfig, PartsDependOnTheTreesOfAUnit) {
  using traces::NodeFormat;
  TrvConfig trv;
  trv.box_testers = 4;
  const auto parts = [&](NodeFormat format, std::uint32_t slots, traces::ChildOrder order = traces::ChildOrder::kSort) {
    return trv.parts({.wide = true, .format = format, .slots = slots, .order = order});
  };
  EXPECT_EQ(count_of(trv.parts({}), "box_tester"), 4U);
  EXPECT_EQ(count_of(trv.parts({}), "comparator"), 0U) << "a tester compares two children";
  EXPECT_EQ(count_of(trv.parts({}), "node_decoder"), 0U);
  EXPECT_EQ(count_of(parts(NodeFormat::kFp32, 4), "box_tester"), 4U);
  EXPECT_EQ(count_of(parts(NodeFormat::kFp32, 4), "comparator"), 5U);
  EXPECT_EQ(count_of(parts(NodeFormat::kQ8, 8), "box_tester"), 0U);
  EXPECT_EQ(count_of(parts(NodeFormat::kQ8, 8), "box_tester_q8"), 4U);
  EXPECT_EQ(count_of(parts(NodeFormat::kQ8, 8), "comparator"), 19U);
  EXPECT_EQ(count_of(parts(NodeFormat::kQ8, 8), "node_decoder"), 1U);
  EXPECT_EQ(count_of(parts(NodeFormat::kQ12, 8, traces::ChildOrder::kNearest), "box_tester_q12"), 4U);
  EXPECT_EQ(count_of(parts(NodeFormat::kQ12, 8, traces::ChildOrder::kNearest), "comparator"), 7U);
  EXPECT_EQ(count_of(parts(NodeFormat::kCw80, 8, traces::ChildOrder::kOctant), "comparator"), 0U);
  EXPECT_EQ(count_of(IstConfig().parts({.leaf = traces::LeafFormat::kBlock128}), "block_decoder"), 1U);
  EXPECT_EQ(count_of(IstConfig().parts({}), "block_decoder"), 0U);
}

TEST(TniConfig, ATrailOfWideTreesTakesMoreBitsPerLevel) {
  TniConfig config;
  config.trv.stack = StackScheme::kRestartTrail;
  const std::uint64_t binary = config.trv_sram_bytes();
  // 32 levels of 4 or 3 bits instead of 1.
  EXPECT_EQ(config.trv_sram_bytes({.wide = true, .slots = 8}), binary + config.trv.rays * 12);
  EXPECT_EQ(config.trv_sram_bytes({.wide = true, .slots = 6}), binary + config.trv.rays * 8);
  config.trv.stack = StackScheme::kFull;
  EXPECT_EQ(config.trv_sram_bytes({.wide = true, .slots = 8}), binary);
}

TEST(TniConfig, ATableOfWaitingRaysIsStorageOfItsUnit) {
  TniConfig config;
  const std::uint64_t trv = config.trv_sram_bytes(), ist = config.ist_sram_bytes();
  EXPECT_EQ(trv, 16 * 1024 + 32 * (96 + 8 * 8));
  config.miss_handling = MissHandling::kRau;
  EXPECT_EQ(config.trv_sram_bytes(), trv + 16 * (4 * 96 + 64));
  EXPECT_EQ(config.ist_sram_bytes(), ist + 16 * (4 * 96 + 64));
}

}  // namespace
}  // namespace hw
