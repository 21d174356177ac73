#include <cstdlib>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/io/file.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/tools/program.h"
#include "tools/analysis/report.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/stored_frames.h"
#include "traces/trace_file/trace_writer.h"

// Tests that replays of one recording on random machines equal runs. RAYWATT_REPLAYS sets the number of machines.

namespace test {
namespace {

std::uint64_t machines_wanted() {
  const char* wanted = std::getenv("RAYWATT_REPLAYS");
  return wanted == nullptr ? 3 : std::strtoull(wanted, nullptr, 10);
}

tools::JobOptions options_for(const std::filesystem::path& config) {
  tools::JobOptions options;
  options.config = config.string();
  options.threads = 1;
  return options;
}

/// Returns random settings of keys that affect timing or traversal, and one of several tree layouts in turn.
tools::RunConfig random_machine(std::uint64_t seed, traces::InstanceLevels levels) {
  tools::RunConfig config = tools::load_run_config({});
  *config.gpu = hw::test::random_config(seed);
  config.gpu->tni.dispatcher.sort = hw::RaySort::kNone;  // recorded work has no keys by which rays are sorted
  config.bvh.boxes = (seed & 1) != 0 ? traces::BoxRecords::kSingle : traces::BoxRecords::kPair;
  config.bvh.triangle_bytes = (seed & 2) != 0 ? 36 : 48;
  config.render.width = 48;
  config.render.height = 32;
  config.bvh.instances = levels;
  config.scene.name = levels == traces::InstanceLevels::kFlatten ? "teapot" : "chess";
  return config;
}

std::filesystem::path write_config(const TempFolder& folder, std::uint64_t seed, traces::InstanceLevels levels) {
  const tools::RunConfig config = random_machine(seed, levels);
  return folder.write("machine" + std::to_string(seed) + ".yaml", sim::dump_config(config));
}

void expect_same_on_machines(std::uint64_t count, traces::InstanceLevels levels) {
  const TempFolder folder;
  const std::filesystem::path trace = folder.path() / "a.trace";
  {
    const tools::JobOptions options = options_for(write_config(folder, 0, levels));
    const tools::Inputs inputs = tools::load_inputs(options);
    traces::TraceWriter writer(trace, tools::trace_header(inputs, options));
    tools::simulate_frame(inputs, {}, 1, {.rates = nullptr, .trace = &writer});
    writer.end_frame(tools::recorded_frame(0, {}));
    writer.commit();
  }
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE(seed);
    const tools::JobOptions options = options_for(write_config(folder, seed, levels));
    const tools::Inputs inputs = tools::load_inputs(options);
    const tools::FrameResult run = tools::simulate_frame(inputs, {}, 1);
    tools::StoredFrames frames(trace, options);
    const tools::RunResult replayed = tools::run(frames, {});
    EXPECT_EQ(sim::config_hash(frames.inputs().config), sim::config_hash(inputs.config));
    EXPECT_EQ(tools::totals_json({run}), tools::totals_json(replayed.report_totals()));
    ASSERT_EQ(run.units.size(), replayed.total->units.size());
    for (std::size_t u = 0; u < run.units.size(); ++u) {
      const sim::UnitReport &a = run.units[u], &b = replayed.total->units[u];
      EXPECT_EQ(a.cycles_by_reason, b.cycles_by_reason) << a.path;
      for (std::size_t c = 0; c < a.counters.size(); ++c) {
        EXPECT_EQ(a.counters[c].value, b.counters[c].value) << a.path << '.' << a.counters[c].name;
      }
    }
  }
}

TEST(ReplayMachines, GiveTheReportOfARun) {
  expect_same_on_machines(machines_wanted(), traces::InstanceLevels::kFlatten);
}

TEST(ReplayMachines, GiveTheReportOfARunWithTwoLevels) {
  expect_same_on_machines((machines_wanted() + 1) / 2, traces::InstanceLevels::kTwoLevel);
}

}  // namespace
}  // namespace test
