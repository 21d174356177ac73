#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "hw_models/machines/livelock_timeout.h"
#include "shader_kernels/catalogue.h"
#include "sim/engine.h"
#include "tests/hw_models/machines/gpu_harness.h"

namespace hw {
namespace {

/// Returns a tile that never ends: its second launch waits for an item that the first one does not have.
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
  void release_work(const traces::TileWork*) override { FAIL() << "it must never come back"; }

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
    for (const sim::UnitReport& unit : gpu->unit_reports()) {
      if (unit.path.ends_with(".tile_buffer")) continue;  // the shader core reports how full it is
      EXPECT_NE(stuck.state.find(unit.path + ": "), std::string::npos) << unit.path << " is not in\n" << stuck.state;
    }
    EXPECT_NE(stuck.state.find("node 1 0/5"), std::string::npos) << "who waits for what:\n" << stuck.state;
  }
}

TEST(Gpu, AStuckMachineReportsTheStateOfEveryUnit) {
  expect_stuck([](Gpu& gpu) { sim::run<sim::Skip::kOn>(gpu); });
}

TEST(Gpu, TheShuffledEngineFindsAStuckMachineToo) {
  expect_stuck([](Gpu& gpu) { sim::run_shuffled(gpu, 1); });
}

TEST(Gpu, TheOracleFindsAStuckMachineToo) {
  expect_stuck([](Gpu& gpu) { sim::run<sim::Skip::kOff>(gpu); });
}

TEST(Gpu, AMachineSlowerThanItsWatchdogReportsTheStateOfEveryUnit) {
  GpuConfig config;
  config.watchdog = 2;  // shorter than the first kernel's configuration
  EXPECT_THROW(test::play(test::cornell_64x32(), config), sim::Deadlock);
}

TEST(LivelockTimeout, GrowsWithEverythingThatARequestCanWaitFor) {
  const GpuConfig plain;
  const auto grows = [&](const char* what, auto&& change) {
    GpuConfig config;
    change(config);
    EXPECT_GT(livelock_timeout(config, {}, {}), livelock_timeout(plain, {}, {})) << what;
    EXPECT_LT(livelock_timeout(config, {}, {}), 20 * livelock_timeout(plain, {}, {})) << what;
  };
  for (auto timing :
       {&DramTiming::rfc_ab, &DramTiming::xp, &DramTiming::rp_ab, &DramTiming::rc, &DramTiming::rcd, &DramTiming::rl,
        &DramTiming::dqsck, &DramTiming::wr, &DramTiming::wtr_l, &DramTiming::faw, &DramTiming::ccd_l}) {
    grows("a timing of memory", [&](GpuConfig& c) { c.dram.timing.*timing += 1000; });
  }
  grows("TRVs", [](GpuConfig& c) { c.tni.trvs *= 2; });
  grows("misses of TRVs", [](GpuConfig& c) { c.tni.trv.l1.mshrs *= 2; });
  grows("misses of ISTs", [](GpuConfig& c) { c.tni.ist.l1.mshrs *= 2; });
  grows("misses of shader cores", [](GpuConfig& c) { c.srp.data_cache.mshrs *= 2; });
  grows("transfers", [](GpuConfig& c) { c.dma.depth *= 2; });
  grows("links", [](GpuConfig& c) { c.interconnect.link_depth *= 2; });
  grows("reads of a channel", [](GpuConfig& c) { c.dram.controller.read_queue *= 2; });
  grows("writes of a channel", [](GpuConfig& c) { c.dram.controller.write_queue *= 2; });
  grows("misses of the L2", [](GpuConfig& c) { c.l2.cache.mshrs *= 2; });
  grows("cores", [](GpuConfig& c) { c.cores *= 2; });
  grows("channels", [](GpuConfig& c) { c.dram.channels *= 2; });
  grows("wires", [](GpuConfig& c) { c.interconnect.latency += 10; });
  grows("hits of the L2", [](GpuConfig& c) { c.l2.cache.hit_cycles.value += 10; });
}

TEST(LivelockTimeout, CoversEightChunksOfTheLongestKernel) {
  GpuConfig config;
  config.clocks.srp = {1'000'000'000};
  config.srp.chunk = 1000;
  config.srp.switch_cycles = 50;
  KernelSchedule kernel;
  kernel.ii = 3;  // three rows of 128 bytes, 64 bytes loaded a cycle
  kernel.depth = 20;
  const std::vector<KernelSchedule> kernels = {kernel, {}};
  const std::vector<BankConflicts> conflicts(2);
  const sim::Time none = livelock_timeout(config, {}, {});
  EXPECT_EQ(livelock_timeout(config, kernels, conflicts) - none,
            8U * (1000 * 3 + 20 + 6) * sim::kFemtosecondsPerNanosecond);
  config.watchdog = 7;
  EXPECT_EQ(livelock_timeout(config, kernels, conflicts), 7U * config.clocks.tni.clock().period());
}

}  // namespace
}  // namespace hw
