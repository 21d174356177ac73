#include "hw_models/tni/tni_config.h"

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/error.h"

namespace hw {
namespace {

TEST(TniConfig, OnlyTheRestartTrailWorksWithoutAStack) {
  TniConfig config;
  config.trv.stack_entries = 0;
  for (const StackScheme scheme : {StackScheme::kFull, StackScheme::kRestartLink}) {
    config.trv.stack = scheme;
    EXPECT_THROW(sim::check_config(config), sim::InputError);
  }
  config.trv.stack = StackScheme::kRestartTrail;
  EXPECT_NO_THROW(sim::check_config(config));
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
