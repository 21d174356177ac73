#include "tests/hw_models/machines/monotone.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "tests/full_size.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"

// Checks that doubling a resource slows no frame by more than 1 %, on machines near the default, and with ideal
// resources on the default machine. monotone.cc lists exceptions; tests/validation/DEVIATIONS.md explains them. By
// default a few of 200 machines are tested; RAYWATT_MONOTONE=200 tests all, as tools/validate does.

namespace hw {
namespace {

using test::Frame;
using test::play;

constexpr double kSlower = 1;  ///< maximum slow-down in percent

struct Sample {
  std::string_view scene;
  std::uint64_t machines;  ///< number of machines to test by default
};

double slower(sim::Time base, sim::Time improved) {
  return 100 * (static_cast<double>(improved) / static_cast<double>(base) - 1);
}

class Monotone : public ::testing::TestWithParam<Sample> {};

TEST_P(Monotone, MoreMshrsBiggerCachesOrMoreChannelsSlowNoFrameByOverOnePercentUnlessListed) {
  const char* all = std::getenv("RAYWATT_MONOTONE");
  const std::uint64_t machines = all == nullptr ? GetParam().machines : std::strtoull(all, nullptr, 10);
  const Frame frame(std::string(GetParam().scene), 256, 128);
  const std::vector<traces::TileWork> works = frame.record();
  std::uint64_t exceptions = 0;
  double worst = 0;
  for (std::uint64_t seed = 0; seed < machines; ++seed) {
    const GpuConfig base = test::sane_config(seed);
    const test::Improvement& improvement = test::improvement_of(seed);
    GpuConfig improved = base;
    improvement.apply(improved);
    sim::check_config(improved);
    const double percent = slower(play(frame, works, base).elapsed, play(frame, works, improved).elapsed);
    const test::KnownSlower* known = test::known_slower(GetParam().scene, seed);
    const std::string pair =
        fmt::format("{{\"{}\", {}, {:.2f}}},  // {}", GetParam().scene, seed, percent, improvement.name);
    if (known != nullptr) {
      EXPECT_NEAR(percent, known->percent, 0.01) << pair;
    } else {
      EXPECT_LE(percent, kSlower) << pair;
    }
    exceptions += percent > kSlower ? 1 : 0;
    worst = std::max(worst, percent);
  }
  RecordProperty("machines", std::to_string(machines));
  RecordProperty("slower_by_over_one_percent", std::to_string(exceptions));
  RecordProperty("worst_percent", fmt::format("{:.2f}", worst));
}

class IdealPart : public ::testing::TestWithParam<const char*> {};

TEST_P(IdealPart, OfTheDefaultMachineSlowsNoFrameByOverOnePercent) {
  // A small picture of the small scene has too few tiles for such a bound.
  const std::uint32_t width = ::test::is_full_size() || GetParam() == std::string_view("cornell") ? 256 : 128;
  const Frame frame(GetParam(), width, width / 2);
  const std::vector<traces::TileWork> works = frame.record();
  const sim::Time base = play(frame, works, {}).elapsed;
  for (const IdealConfig::Resource& resource : IdealConfig::kResources) {
    GpuConfig config;
    config.ideal.*resource.member = true;
    EXPECT_LE(slower(base, play(frame, works, config).elapsed), kSlower) << resource.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Monotone, ::testing::Values(Sample{"cornell", 4}, Sample{"chess", 1}),
                         [](const auto& part) { return std::string(part.param.scene); });
INSTANTIATE_TEST_SUITE_P(Scenes, IdealPart, ::testing::Values("cornell", "chess", "conference"),
                         [](const auto& part) { return std::string(part.param); });

}  // namespace
}  // namespace hw
