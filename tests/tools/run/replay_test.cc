#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/wait.h>

#include "sim/config/config.h"
#include "sim/io/file.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/tools/program.h"
#include "tests/tools/run/trace_bytes.h"
#include "tools/analysis/report.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/stored_frames.h"
#include "traces/trace_file/trace_writer.h"

// Tests that a replay gives exactly the report of the run, or else one line with the reason.

namespace test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Returns the parts of a report that are equal for equal inputs.
Json repeatable(const fs::path& folder) {
  Json report = read_json(folder / "report.json");
  report.erase("host");
  report["provenance"].erase("argv");
  return report;
}

/// Expects success with no warnings except about extrapolated caches.
void expect_good(const ProcessResult& ending) {
  EXPECT_EQ(ending.exit, 0) << ending.err;
  std::istringstream lines(ending.err);
  for (std::string line; std::getline(lines, line);) EXPECT_TRUE(line.ends_with("is extrapolated")) << line;
}

class Replay : public ::testing::Test {
 protected:
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  std::string trace() const { return at("a.trace").string(); }
  void run(const std::string& out, Words more, bool record = false) const {
    if (record) more.insert(more.end(), {"--record", trace()});
    expect_good(raywatt(small_run(at(out), more)));
  }
  ProcessResult replay(const std::string& out, const Words& more = {}, const Words& config = {},
                       const std::string& threads = "1") const {
    Words words = {"trace", "replay"};
    words.insert(words.end(), config.begin(), config.end());
    words.insert(words.end(), {trace(), "-o", at(out).string(), "--threads", threads});
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words);
  }
  void expect_same(const std::string& a, const std::string& b) const {
    EXPECT_EQ(repeatable(at(a)), repeatable(at(b)));
    EXPECT_EQ(read_bytes(at(a) / "report.txt"), read_bytes(at(b) / "report.txt"));
    EXPECT_EQ(read_bytes(at(a) / "config.yaml"), read_bytes(at(b) / "config.yaml"));
  }

  TempFolder folder_;
};

TEST_F(Replay, AndOtherRecordedWorkAreRefusedIfRaysAreSorted) {
  const Words sort = {"--set", "tni.dispatcher.sort=origin_octant"};
  const auto with_sort = [&](Words more) {
    more.insert(more.end(), sort.begin(), sort.end());
    return more;
  };
  const auto refused = [&](const Words& more) { return raywatt(small_run(at("no"), with_sort(more))); };
  expect_refusal(refused({"--record", trace()}), {"--record: recorded work", "allowed: tni.dispatcher.sort=none"});
  expect_refusal(refused({"--replicates", "2"}), {"--replicates: recorded work"});
  expect_refusal(raywatt(with_sort({"trace", "record", trace(), "--resolution", "16x16"})),
                 {"trace record: recorded work", "allowed: tni.dispatcher.sort=none"});
  EXPECT_FALSE(fs::exists(trace()));
  run("run", {}, true);
  expect_refusal(replay("no", sort), {"a.trace: recorded work", "allowed: tni.dispatcher.sort=none"});
  EXPECT_FALSE(fs::exists(at("no")));
}

TEST_F(Replay, GivesTheReportOfTheRunForEveryFrameProgram) {
  const std::vector<Words> runs = {
      {},
      {"--program", "full:4", "--scene", "chess"},
      {"--program", "multirate:under", "--reference", "full:1"},
      {"--program", "undersample"},
      {"--program", "supersample"},
      {"--set", "bvh.numbers=hybrid", "--set", "bvh.boxes=single"},
      {"--scene", "chess", "--set", "scene.triangles=20000", "--set", "bvh.instances=two_level"},
      {"--scene", "laboratory", "--set", "scene.triangles=20000", "--set", "bvh.instances=two_level", "--program",
       "multirate:under"},
      {"--set", "render.primary=raster", "--program", "reconstruct"},
      {"--set", "direct_interface.enabled=false"}};
  for (const Words& words : runs) {
    SCOPED_TRACE(words.empty() ? "default" : words.back());
    run("run", words, true);
    expect_good(replay("replay"));
    expect_same("run", "replay");
    Words expected = {"config.yaml", "intervals.bin.zst", "report.json", "report.txt", "tiles.json"};
    if (std::ranges::count(words, "--reference") != 0)
      expected.insert(expected.begin() + 2, {"reference-tiles.json", "reference.json"});
    EXPECT_EQ(names_in(at("replay")), expected) << "no pictures";
  }
}

TEST_F(Replay, GivesTheReportOfAnAnimationWithItsReference) {
  run("run", {"--scene", "chess", "--frames", "20:22", "--program", "multirate:super", "--reference", "full:1"}, true);
  expect_good(replay("replay"));
  expect_same("run", "replay");
  const ProcessResult threads = replay("threads", {"--progress", "json"}, {}, "3");
  EXPECT_SAYS(threads.err, "\"part\":6,\"parts\":6");
  expect_same("run", "threads");
}

TEST_F(Replay, RecordingChangesNothingAndRecordingAloneMakesTheSameFile) {
  run("with", {"--frames", "1"}, true);
  run("without", {"--frames", "1"});
  expect_same("with", "without");
  const std::string alone = at("alone.trace").string();
  expect_good(raywatt({"trace", "record", "--resolution", "64x32", "--frames", "1", alone, "--quiet"}));
  EXPECT_EQ(read_bytes(trace()), read_bytes(alone));
}

TEST_F(Replay, OnAnotherMachineGivesTheReportOfARunOnIt) {
  run("recorded", {"--scene", "teapot"}, true);
  const Words changes = {"--set",   "cores=2",
                         "--set",   "tni.trv.stack=restart_trail",
                         "--set",   "tni.trv.box_testers=1",
                         "--set",   "bvh.triangle_bytes=36",
                         "--ideal", "dram"};
  Words words = {"--scene", "teapot"};
  words.insert(words.end(), changes.begin(), changes.end());
  run("run", words);
  expect_good(replay("replay", changes));
  expect_same("run", "replay");
}

TEST_F(Replay, OfTwoLevelsGivesTheReportsOfRunsOnOtherMachines) {
  const Words levels = {"--scene", "chess", "--set", "scene.triangles=20000", "--set", "bvh.instances=two_level"};
  run("recorded", levels, true);
  const std::vector<Words> machines = {
      {"--set", "cores=2", "--set", "tni.trv.stack=restart_trail", "--set", "bvh.boxes=single"},
      {"--set", "tni.trv.stack=restart_link", "--set", "tni.trv.stack_entries=2", "--set", "tni.trv.box_testers=1"},
      {"--set", "tni.trv.l1.size=1 KiB", "--set", "tni.trv.prefetch=sibling", "--set", "bvh.triangle_bytes=36"}};
  for (const Words& changes : machines) {
    SCOPED_TRACE(changes[1]);
    Words words = levels;
    words.insert(words.end(), changes.begin(), changes.end());
    run("run", words);
    expect_good(replay("replay", changes));
    expect_same("run", "replay");
  }
  expect_refusal(replay("out", {"--set", "bvh.instances=flatten"}),
                 {trace(), "bvh.instances was recorded as two_level"});
}

TEST_F(Replay, OfTwoLevelsThatMove) {
  run("run",
      {"--scene", "chess", "--set", "scene.triangles=20000", "--frames", "20:21", "--set", "bvh.instances=two_level"},
      true);
  expect_good(replay("replay"));
  expect_same("run", "replay");
}

TEST_F(Replay, TakesAConfigurationAndWhatTheRecordingCommandSaidOfTheWork) {
  const std::string config = folder_.write("two.yaml", "extends: sgrt-2016\ncores: 2\n").string();
  run("recorded", {"--scene", "teapot"}, true);
  expect_good(raywatt({"run", config, "--scene", "teapot", "--resolution", "64x32", "-o", at("run").string()}));
  expect_good(replay("replay", {}, {config}));
  expect_same("run", "replay");
}

TEST_F(Replay, OfOtherWorkIsRefusedAndTheKeyNamed) {
  run("recorded", {}, true);
  expect_refusal(replay("out", {"--set", "render.depth=2"}),
                 {trace(), "render.depth was recorded as", "and 2 is asked for"});
  const std::string config = folder_.write("c.yaml", "extends: sgrt-2016\nbvh:\n  leaf_size: 2\n").string();
  expect_refusal(replay("out", {}, {config}), {trace(), "bvh.leaf_size was recorded as 4", "and 2 is asked for"});
  expect_refusal(replay("out", {"--set", "scene.name=teapot"}), {"scene.name", "\"cornell\"", "\"teapot\""});
  EXPECT_FALSE(fs::exists(at("out")));
}

TEST_F(Replay, TakesAnyValueOfKeysThatNothingInTheFileReads) {
  run("recorded", {}, true);
  expect_good(replay("out", {"--set", "limits.memory=1GiB", "--set", "limits.json_depth=9", "--set",
                             "supersample.colour=0.5", "--set", "multirate.block=4"}));
  run("recorded", {"--program", "full:4", "--reference", "supersample"}, true);
  expect_refusal(replay("no", {"--set", "supersample.colour=0.5"}), {trace(), "supersample.colour was recorded as"});
}

TEST_F(Replay, RecordsIntoTheFolderOfTheReportEvenIfThatIsNew) {
  const auto recorded_at = [&](const std::string& file) { return raywatt(small_run(at("new"), {"--record", file})); };
  const std::string file = (at("new") / "a.trace").string();
  for (int time = 0; time < 2; ++time) {
    expect_good(recorded_at(file));
    EXPECT_EQ(names_in(at("new")), (Words{"a.trace", "config.yaml", "image.exr", "image.png", "intervals.bin.zst",
                                          "pixels.exr", "report.json", "report.txt", "tiles.json"}));
    expect_good(raywatt({"trace", "info", file}));
  }
  fs::remove_all(at("new"));
  expect_refusal(recorded_at((at("new") / "deep" / "a.trace").string()),
                 {"deep/a.trace: cannot be written", "there is no folder " + (at("new") / "deep").string()});
  EXPECT_EQ(names_in(folder_.path()), Words{});
}

TEST_F(Replay, InfoDescribesTheFile) {
  run("run", {"--program", "full:4", "--reference", "full:1"}, true);
  const Json report = read_json(at("run") / "report.json");
  const ProcessResult ending = raywatt({"trace", "info", trace(), "--json"});
  expect_good(ending);
  const Json info = Json::parse(ending.out);
  EXPECT_EQ(info["program"], "full:4");
  EXPECT_EQ(info["reference"], "full:1");
  EXPECT_EQ(info["resolution"], Json({64, 32}));
  EXPECT_EQ(info["scene"]["sha256"], report["provenance"]["scene_sha256"]);
  EXPECT_EQ(info["bytes"], fs::file_size(trace()));
  EXPECT_EQ(info["trees"], 1);
  EXPECT_GT(info["rays"], report["totals"]["rays"]["total"]) << "the reference's, too";
  EXPECT_EQ(info["function"]["render.width"], "64");
  EXPECT_FALSE(info["function"].contains("cores"));
  EXPECT_SAYS(raywatt({"trace", "info", trace()}).out, "raywatt-trace/5");
}

TEST_F(Replay, BadFilesAreRefusedInOneLine) {
  run("run", {}, true);
  const std::string good = read_bytes(trace());
  const auto is_refused = [&](const std::string& bytes, const Words& parts) {
    folder_.write("a.trace", bytes);
    expect_refusal(replay("out"), parts);
    expect_refusal(raywatt({"trace", "info", trace()}), parts);
  };
  is_refused("", {trace(), "is no trace"});
  is_refused(good.substr(0, good.size() / 2), {trace(), "ends early"});
  is_refused(good + "more", {trace(), "with something other than a footer"});
  std::string first_line = good;
  first_line[14] = '\0';
  is_refused(first_line, {trace(), "another format", "this program reads 'raywatt-trace/5'", "record makes one"});
  std::string bad = good;
  bad[30] = '\x7f';
  is_refused(bad, {trace(), "damaged"});
  bad = good;
  bad[good.size() / 2] = static_cast<char>(bad[good.size() / 2] ^ 1);  // damages a tile
  folder_.write("a.trace", bad);
  expect_refusal(replay("out"), {trace(), "frame 0, tile", "damaged"});
  EXPECT_FALSE(fs::exists(at("out")));
  expect_refusal(raywatt({"trace", "replay", at("no.trace").string()}), {"no.trace: no such file"});
}

TEST_F(Replay, BadFilesThatGrowWhenTheyAreReadAreRefusedInOneLine) {
  const std::string begin = "raywatt-trace/5\n", end = "end\n";
  const auto file = [&](const std::string& header, const std::string& contents) {
    const std::string first = block(header), last = block(contents);
    const std::string start = begin + number(first.size(), 4) + first;
    return start + last + number(start.size(), 8) + number(last.size(), 4) + end;
  };
  const auto is_refused = [&](const std::string& bytes, const Words& parts) {
    EXPECT_LT(bytes.size(), 20'000U);
    folder_.write("a.trace", bytes);
    expect_refusal(replay("out"), parts);
    expect_refusal(raywatt({"trace", "info", trace()}), parts);
  };
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  const std::string similar = R"({"trees":[],"frames":[],"parts":[{"result":{"sampling":{"similar":)" + deep + "}}}]}";
  const std::string too_deep = "is nested too deeply; allowed: 64 levels";
  is_refused(file("{}", similar), {trace(), too_deep});
  is_refused(file(deep, "{}"), {trace(), too_deep});
  is_refused(file("{}", std::string(60'000'000, '[')), {trace(), "that holds 60000000; allowed: 262144"});
  is_refused(file("{}", std::string(100'000'000, ' ')), {trace(), "that holds 100000000; allowed: 262144"});
}

TEST_F(Replay, APipeIsNotWaitedFor) {
  ASSERT_EQ(::mkfifo(trace().c_str(), 0600), 0);
  const Words small = {"trace", "record", "--resolution", "64x32", trace()};
  expect_refusal(raywatt(small), {trace(), "is not a regular file"});
  expect_refusal(raywatt(small_run(at("out"), {"--record", trace()})), {trace(), "is not a regular file"});
  EXPECT_TRUE(fs::is_fifo(trace()));
}

TEST_F(Replay, MemoryThatRunsOutIsSaidInOneLine) {
#ifdef RAYWATT_SANITIZED
  GTEST_SKIP() << "sanitizers take more than there is from the start";
#endif
  const std::string script = folder_.write("small", "ulimit -v 300000; exec \"$@\"\n").string();
  const std::string err = at("err").string();
  const int status =
      std::system(("sh " + script + " " RAYWATT_PROGRAM " trace record --quiet --resolution 16384x16384 --threads 1 " +
                   trace() + " 2> " + err)
                      .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 74);
  const std::string said = read_bytes(err);
  EXPECT_TRUE(said.starts_with("raywatt: out of memory: ")) << said;
  EXPECT_EQ(said.find('\n'), said.size() - 1) << said;
  EXPECT_FALSE(fs::exists(trace()));
}

TEST_F(Replay, AFailedWriteLeavesNoFiles) {
  ProcessEnvironment small;
  small.longest_file = 10'000;
  const ProcessResult full = raywatt({"trace", "record", "--resolution", "64x32", trace()}, small);
  EXPECT_EQ(full.exit, 74) << full.err;
  EXPECT_SAYS(full.err, "cannot be written");
  EXPECT_EQ(names_in(folder_.path()), Words{});
  expect_refusal(raywatt({"trace", "record", "--resolution", "64x32", at("no/such/a.trace").string()}),
                 {"cannot be written", "there is no folder " + at("no/such").string()});
  folder_.write("thesis.txt", "three years");
  expect_refusal(raywatt({"trace", "record", "--resolution", "64x32", at("thesis.txt").string()}), {"is no trace"});
  EXPECT_EQ(read_bytes(at("thesis.txt")), "three years");
}

// Tests that replays of one recording on random machines equal runs. RAYWATT_REPLAYS sets the number of machines.

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
