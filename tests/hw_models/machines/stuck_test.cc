#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "sim/engine.h"
#include "tests/hw_models/machines/gpu_harness.h"

namespace hw {
namespace {

/// One tile whose second launch waits for an item that the first one does not have.
class TileThatNeverEnds final : public TileSource {
 public:
  TileThatNeverEnds() {
    for (const std::uint32_t items : {4U, 5U}) {
      traces::WorkNode& launch = work_.nodes.emplace_back();
      launch.kernel = kernels::kKernelId<kernels::PackColour>;
      launch.items = items;
    }
    work_.nodes[1].inputs.push_back({0, traces::Edge::Kind::kEach});
  }
  const traces::TileWork* next() override { return std::exchange(given_, true) ? nullptr : &work_; }
  void give_back(const traces::TileWork*) override { FAIL() << "it must never come back"; }

 private:
  traces::TileWork work_;
  bool given_ = false;
};

template <class Run>
void expect_stuck(Run&& run) {
  TileThatNeverEnds tile;
  GpuConfig config;
  config.cores = 2;
  const auto gpu = std::make_unique<Gpu>(config, test::cornell_64x32().workload(), tile);
  try {
    run(*gpu);
    FAIL() << "the machine ended";
  } catch (const sim::Deadlock& stuck) {
    for (const sim::UnitReport& unit : gpu->report()) {
      if (unit.path.ends_with(".tile_buffer")) continue;  // its shader core tells how full it is
      EXPECT_NE(stuck.state.find(unit.path + ": "), std::string::npos) << unit.path << " is not in\n" << stuck.state;
    }
    EXPECT_NE(stuck.state.find("node 1 0/5"), std::string::npos) << "who waits for what:\n" << stuck.state;
  }
}

TEST(Gpu, AMachineThatIsStuckSaysSoWithTheStateOfEveryUnit) {
  expect_stuck([](Gpu& gpu) { sim::run<sim::Skip::kOn>(gpu); });
}

TEST(Gpu, TheShuffledEngineFindsAStuckMachineToo) {
  expect_stuck([](Gpu& gpu) { sim::run_shuffled(gpu, 1); });
}

TEST(Gpu, TheOracleFindsAStuckMachineToo) {
  expect_stuck([](Gpu& gpu) { sim::run<sim::Skip::kOff>(gpu); });
}

}  // namespace
}  // namespace hw
