#include "tools/studies/bottleneck/bottleneck.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "hw_models/machines/gpu_config.h"
#include "tests/full_size.h"

// Tests that the resource estimated as bottleneck from one run's counters gives the largest speed-up if ideal, within 2
// %. Uses small built-in scenes on machines with different bottlenecks, at full size larger ones.

namespace tools {
namespace {

struct Case {
  const char* name;
  const char* scene;
  std::vector<std::string> sets;
  const char* resolution = "256x128";
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class NamedLimiter : public ::testing::TestWithParam<Case> {};

TEST_P(NamedLimiter, IsWorthMostWithinTwoPercent) {
  JobOptions options;
  options.scene = GetParam().scene;
  options.sets = GetParam().sets;
  options.resolution = test::is_full_size() ? GetParam().resolution : "128x64";
  options.threads = 2;
  const Bottleneck b = find_bottleneck(options);
  ASSERT_EQ(b.bounds.size(), hw::IdealConfig::kResources.size());
  const auto speedup = [&](const Bound& bound) { return b.speedup_of(bound); };
  const double best = speedup(std::ranges::max(b.bounds, {}, speedup));
  const Bound named = *std::ranges::find(b.bounds, b.named, &Bound::resource);
  EXPECT_GE(speedup(named), 0.98 * best) << b.named << ": " << b.limiter;
  EXPECT_GT(best, 1.02) << "something must be worth something";
}

INSTANTIATE_TEST_SUITE_P(
    Machines, NamedLimiter,
    ::testing::Values(Case{"chess", "chess", {}}, Case{"cornell", "cornell", {}, "512x256"},
                      Case{"atrium_one_trv", "atrium", {"tni.trvs=1"}},
                      Case{"forest_slow_unit", "forest", {"clocks.tni=150 MHz"}},
                      Case{"car_two_channels", "car", {"dram.channels=2", "l2.size=64 KiB"}},
                      Case{"teapot", "teapot", {}},
                      Case{"rasterised", "conference", {"render.primary=raster", "render.effects=none"}, "128x64"}),
    [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace tools
