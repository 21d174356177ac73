#include "tools/studies/sweep/spec/spec.h"

#include <chrono>
#include <set>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "tests/tools/studies/sweep/small_sweep.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "tools/studies/sweep/spec/point.h"

// Tests of reading a sweep file, and of the points that it defines.

namespace test {
namespace {

Words values_of(const std::string& axis) {
  Words values;
  for (const auto& point : points_of("axes:\n  " + axis + "\n")) values.push_back(point.axes.at(0).second);
  return values;
}

TEST(SweepSpec, WithoutAxesIsOnePoint) {
  const auto points = points_of("sets: [cores=2]\nprogram: full:4\n");
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].program, "full:4");
  EXPECT_EQ(points[0].resolution, "16x16");
  EXPECT_EQ(points[0].sets, Words{"cores=2"});
}

TEST(SweepSpec, TheLastAxisVariesFastest) {
  EXPECT_EQ(axis_labels(points_of("axes: {cores: [1, 2], tni.trvs: [2, 4]}\n")),
            (Words{"cores=1 tni.trvs=2", "cores=1 tni.trvs=4", "cores=2 tni.trvs=2", "cores=2 tni.trvs=4"}));
}

TEST(SweepSpec, WorkloadsAndProgramsAreTheOuterAxes) {
  const auto points = points_of(
      "axes: {cores: [1, 2]}\nprograms: [full:1, full:4]\n"
      "workloads:\n  - cornell\n  - {scene: teapot, resolution: 32x16, name: pot}\n");
  ASSERT_EQ(points.size(), 8U);
  EXPECT_EQ(axis_labels(points)[0], "workload=cornell program=full:1 cores=1");
  EXPECT_EQ(axis_labels(points)[7], "workload=pot program=full:4 cores=2");
  EXPECT_EQ(points[7].scene, "teapot");
  EXPECT_EQ(points[7].resolution, "32x16");
  EXPECT_EQ(points[0].resolution, "16x16") << "the sweep's, where the workload has none";
}

TEST(SweepSpec, RangesByStepFactorAndCount) {
  EXPECT_EQ(values_of("cores: {from: 1, to: 4, step: 1}"), (Words{"1", "2", "3", "4"}));
  EXPECT_EQ(values_of("tni.trv.l1.size: {from: 8 KiB, to: 64 KiB, factor: 2}"),
            (Words{"8 KiB", "16 KiB", "32 KiB", "64 KiB"}));
  EXPECT_EQ(values_of("clocks.tni: {from: 300 MHz, to: 700 MHz, count: 3}"), (Words{"300 MHz", "500 MHz", "700 MHz"}));
}

TEST(SweepSpec, ARangeEndsWhereNumbersDo) {
  const std::string complaint = complaint_of("axes:\n  cores: {from: 1, to: 1.7976931348623157e308, factor: 1e300}\n");
  EXPECT_NE(complaint.find("axes.cores: "), std::string::npos) << complaint;
}

TEST(SweepSpec, ConditionsOfManyValuesHoldForManyCombinations) {
  std::string lines =
      "axes:\n  cores: {from: 1, to: 64, step: 1}\n  tni.trv.rays: {from: 1, to: 64, step: 1}\nexclude:\n";
  for (int i = 0; i < 9000; ++i) lines += "  - {cores: ['" + std::to_string(1000 + i) + "', x]}\n";
  lines += "  - {cores: '> 2'}\n  - {tni.trv.rays: ['1', '2', '3', 'x']}\n";
  EXPECT_EQ(points_of(lines).size(), 2U * 61U);
}

TEST(SweepSpec, AnExclusionWhoseFirstTermHoldsIsLookedAtToItsEnd) {
  EXPECT_EQ(
      axis_labels(points_of("axes: {cores: [1, 2], tni.trvs: [1, 2]}\nexclude:\n"
                            "  - {cores: 2, tni.trvs: 1}\n  - {cores: [7, x7]}\n  - {tni.trvs: cores, cores: 1}\n")),
      (Words{"cores=1 tni.trvs=2", "cores=2 tni.trvs=2"}));
}

TEST(SweepSpec, AnExclusionOfTwoAxesIsLookedAtWhereItsOtherTermsHold) {
  const std::string axes = "axes: {cores: [1, 2, 4], tni.trvs: [1, 2, 4]}\nexclude:\n";
  EXPECT_EQ(axis_labels(points_of(axes + "  - {cores: '<= tni.trvs', tni.trvs: [2, 4]}\n")),
            (Words{"cores=1 tni.trvs=1", "cores=2 tni.trvs=1", "cores=4 tni.trvs=1", "cores=4 tni.trvs=2"}));
  EXPECT_EQ(points_of(axes + "  - {cores: tni.trvs}\n").size(), 6U);
  // Invalid comparisons are refused, whatever the terms after them are.
  const std::string complaint = complaint_of(
      "axes: {cores: [1, 2], tni.trv.l1.size: [8 KiB], tni.trvs: [1]}\n"
      "exclude: [{cores: '< tni.trv.l1.size', tni.trvs: 7}]\n");
  EXPECT_NE(complaint.find("cannot be put in order"), std::string::npos) << complaint;
}

TEST(SweepSpec, RangesOnALogScaleAreRoundedForWholeNumbers) {
  EXPECT_EQ(values_of("tni.trv.rays: {from: 4, to: 64, count: 5, scale: log}"), (Words{"4", "8", "16", "32", "64"}));
  EXPECT_EQ(values_of("tni.trv.rays: {from: 10, to: 20, count: 3, scale: log}"), (Words{"10", "14", "20"}));
}

TEST(SweepSpec, KeysOfOneAxisMoveTogether) {
  const auto same = points_of("axes:\n  l1: {keys: [tni.trv.l1.size, tni.ist.l1.size], values: [8 KiB, 16 KiB]}\n");
  ASSERT_EQ(same.size(), 2U);
  EXPECT_EQ(same[1].sets, (Words{"tni.trv.l1.size=16 KiB", "tni.ist.l1.size=16 KiB"}));
  const auto rows = points_of("axes:\n  size: {keys: [cores, tni.trvs], values: {small: [1, 2], large: [4, 4]}}\n");
  EXPECT_EQ(axis_labels(rows), (Words{"size=small", "size=large"}));
  EXPECT_EQ(rows[0].sets, (Words{"cores=1", "tni.trvs=2"}));
  EXPECT_EQ(axis_labels(points_of("axes:\n  size: {keys: [cores, tni.trvs], values: [[1, 2], [4, 4]]}\n")),
            (Words{"size=1 / 2", "size=4 / 4"}));
}

TEST(SweepSpec, ConditionsCompareAsQuantitiesAndAcrossAxes) {
  const std::string axes = "axes: {cores: [1, 2, 4], tni.trvs: [2, 4]}\n";
  EXPECT_EQ(
      axis_labels(points_of(axes + "exclude:\n  - {cores: [1, 2], tni.trvs: 2}\n  - {cores: 4, tni.trvs: '> 2'}\n")),
      (Words{"cores=1 tni.trvs=4", "cores=2 tni.trvs=4", "cores=4 tni.trvs=2"}));
  EXPECT_EQ(axis_labels(points_of(axes + "where:\n  - {cores: '>= tni.trvs'}\n")),
            (Words{"cores=2 tni.trvs=2", "cores=4 tni.trvs=2", "cores=4 tni.trvs=4"}));
  EXPECT_EQ(
      points_of("axes: {tni.trv.l1.size: [8 KiB, 16 KiB, 32 KiB]}\nwhere: [{tni.trv.l1.size: <= 16384 B}]\n").size(),
      2U);
}

TEST(SweepSpec, EqualPointsHaveEqualIdsHoweverTheyAreSaid) {
  const auto a = points_of("axes: {tni.trv.l1.size: [16 KiB]}\n"),
             b = points_of("axes: {tni.trv.l1.size: [16384 B]}\n"),
             c = points_of("axes: {tni.trv.l1.size: [32 KiB]}\n"), plain = points_of("");
  EXPECT_EQ(a[0].id, b[0].id);
  EXPECT_EQ(a[0].id, plain[0].id) << "the default said aloud";
  EXPECT_NE(a[0].id, c[0].id);
  EXPECT_EQ(a[0].stream, c[0].stream) << "the same work on another machine";
  EXPECT_NE(a[0].stream, points_of("scene: teapot\n")[0].stream);
  EXPECT_NE(a[0].id, points_of("image: yes\n")[0].id);
  EXPECT_NE(a[0].id, points_of("reference: full:4\n")[0].id);
  EXPECT_NE(a[0].id, points_of("program: full:4\n")[0].id);
}

TEST(SweepSpec, APointOfASceneFileDependsOnItsBytes) {
  const TempFolder folder;
  const auto id_of = [&](TinyGltf scene) {
    folder.write("scene.glb", scene.glb());
    const auto file = write_sweep(folder, "scene: ./scene.glb\n");
    return tools::sweep::plan_points(tools::sweep::read_spec(file), folder.path())[0].id;
  };
  TinyGltf other;
  other.node()["translation"] = {0, 0, 1};
  const std::string first = id_of({});
  EXPECT_NE(first, id_of(other));
  EXPECT_EQ(first, id_of({}));
}

TEST(SweepSpec, ValuesThatDoNotGoTogetherMakeAPointWithAnError) {
  const auto points = points_of("axes: {tni.trv.l1.size: [64 B, 16 KiB]}\nsets: [tni.trv.l1.ways=4]\n");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NE(points[0].error, "");
  EXPECT_EQ(points[1].error, "");
  EXPECT_EQ(points[0].id.size(), 64U);
}

TEST(SweepSpec, ALineGivesItsPointBack) {
  for (const auto& point : points_of("axes: {cores: [1, 2]}\nimage: yes\nreference: full:4\nscene: teapot\n")) {
    const std::string line = tools::sweep::format_point_line(point);
    EXPECT_EQ(tools::sweep::format_point_line(tools::sweep::parse_point_line(line, "here")), line);
  }
}

TEST(SweepSpec, RangesMayMixUnitsOfOneKind) {
  const auto points = points_of("axes:\n  l2.size: {from: 128 KiB, to: 1 MiB, factor: 2}\n");
  ASSERT_EQ(points.size(), 4U);
  EXPECT_SAYS(tools::sweep::format_point_line(points.back()), "1024 KiB");
}

TEST(SweepSpec, ComplaintsNameThePlaceTheKeyAndWhatIsAllowed) {
  // Line numbers follow two lines that write_sweep() writes first.
  const std::vector<std::pair<std::string, Words>> wrong = {
      {"axis: {cores: [1]}\n", {"sweep.yaml:3:1: axis: unknown key 'axis', did you mean 'axes'?"}},
      {"axes:\n  core: [1, 2]\n", {"sweep.yaml:4:9: axes.core: core: unknown key", "did you mean 'cores'?"}},
      {"axes:\n  cores: [1, many]\n", {"sweep.yaml:4:10: axes.cores: cores: 'many'"}},
      {"axes:\n  cores: [1, 4096]\n",
       {"sweep.yaml:4:10: axes.cores: cores: '4096' is out of range; allowed: 1 to 64 cores"}},
      {"axes:\n  cores: []\n", {"sweep.yaml:4:10: axes.cores: is empty"}},
      {"axes:\n  cores: [1, 1]\n", {"axes.cores: has '1' twice"}},
      {"axes:\n  cores: 3\n", {"sweep.yaml:4:10: axes.cores: allowed: a mapping"}},
      {"axes:\n  cores: {from: 1}\n", {"axes.cores: allowed: both from and to"}},
      {"axes:\n  cores: {from: 1, to: 4}\n", {"axes.cores: allowed: one of step, factor and count"}},
      {"axes:\n  cores: {from: 4, to: 1, step: 1}\n", {"the step does not lead"}},
      {"axes:\n  cores: {from: 1, to: 1e30, step: 1}\n", {"has more than 10000 values"}},
      {"axes:\n  clocks.tni: {from: 1 MHz, to: 1 GHz, step: 1 KiB}\n", {"in units of one kind"}},
      {"axes:\n  a: {keys: [cores, tni.trvs], values: [[1, 2, 3]]}\n", {"axes.a", "has 3 values for 2 keys"}},
      {"axes:\n  a: {keys: [cores], values: [1]}\n  cores: [2]\n", {"cores: moves 'cores', which 'a' moves already"}},
      {"axes: {program: [full:3]}\n", {"axes.program: ", "full:3"}},
      {"axes: {resolution: [64]}\n", {"axes.resolution: ", "WIDTHxHEIGHT"}},
      {"axes: {cores: [1]}\nexclude: [{core: 1}]\n", {"sweep.yaml:4:18: exclude.core: 'core' is no axis", "'cores'"}},
      {"axes: {cores: [1]}\nwhere: [{cores: '< few'}]\n", {"'1' and 'few' cannot be put in order"}},
      {"axes: {cores: [1]}\nwhere: [{cores: '> 1'}]\n",
       {"sweep.yaml:4:8: where: no points: the conditions leave none"}},
      {"subset: {random: 0}\n", {"sweep.yaml:3:18: subset.random: '0' is not allowed"}},
      {"subset: some\n", {"subset: allowed: grid, or {random: N}"}},
      {"subset: {random: 3, sobol: 4}\n", {"allowed: one of random, latin_hypercube, sobol"}},
      {"workloads: [cornell, teapot]\naxes: {cores: [1, 2]}\nsubset: {random: 2}\n",
       {"sweep.yaml:5:9: subset: draws 'workload' and 'cores' together", "allowed: grid, or one workload"}},
      {"axes: {scene: [cornell, teapot], cores: [1, 2]}\nsubset: {sobol: 2}\n",
       {"sweep.yaml:4:9: subset: draws 'scene' and 'cores' together"}},
      {"image: maybe\n", {"sweep.yaml:3:8: image: 'maybe' is not allowed; allowed: yes, no"}},
      {"scene: teapott\n", {"sweep.yaml:3:8: scene: no scene", "'teapott'", "did you mean 'teapot'?"}},
      {"scene: ./none.glb\n", {"sweep.yaml:3:8: scene: ", "none.glb: no such file"}},
      {"axes: {scene: [teapot, teapott]}\n", {"sweep.yaml:3:15: axes.scene: no scene", "did you mean 'teapot'?"}},
      {"program: full:3\n", {"sweep.yaml:3:10: program: program 'full:3'"}},
      {"program: full\n", {"sweep.yaml:3:10: program: program 'full': the N of full:N"}},
      {"scene: chess\nworkloads: [cornell, teapot]\n",
       {"sweep.yaml:3:8: scene: has no effect, because workloads sets it at every point; allowed: scene or workloads"}},
      {"program: full:4\nprograms: [full:1]\n", {"sweep.yaml:3:10: program: ", "allowed: program or programs"}},
      {"axes: {scene: [cornell]}\nscene: teapot\n", {"sweep.yaml:4:8: scene: ", "allowed: scene or axes.scene"}},
      {"scene: teapot\nprograms: [full:1]\naxes: {scene: [cornell]}\n", {"allowed: scene or axes.scene, not both"}},
      {"resolution: 64x64\naxes: {resolution: [32x32]}\n",
       {"sweep.yaml:3:13: resolution: ", "allowed: resolution or axes.resolution"}},
      {"workloads: [{scene: teapot, resolution: 32x32}]\n",
       {"sweep.yaml:2:13: resolution: ", "allowed: resolution or workloads"}},
      {"frames: 0:2\naxes:\n  work: {keys: [frames, cores], values: [[0:3, 1], [0:4, 2]]}\n",
       {"sweep.yaml:3:9: frames: ", "allowed: frames or axes.work"}},
      {"reference: ful:4\n", {"sweep.yaml:3:12: reference: ", "'ful:4'"}},
      {"tile_sampling: 0%\n", {"sweep.yaml:3:16: tile_sampling: ", "0%"}},
      {"sets: cores=1\n", {"sweep.yaml:3:7: sets: allowed: a list"}},
      {"sets: [cores=1, trvs=2]\n", {"sweep.yaml:3:7: sets: trvs: unknown key 'trvs'"}},
      {"config: sgrt-2061\n",
       {"sweep.yaml:3:9: config: no configuration is called 'sgrt-2061', did you mean 'sgrt-2016'?"}},
      {"tile_sampling: 5%\nreference: full:4\n", {"do not go together"}},
      {"tile_sampling: 5%\nreplicates: 3\n", {"replicates and tile_sampling do not go together"}},
      {"representative: 5%\n", {"sweep.yaml:3:17: representative: ", "5%"}},
      {"representative: auto\nreference: full:4\n", {"representative: does not go with reference"}},
      {"representative: auto\nreplicates: 3\n", {"representative: does not go with replicates"}},
      {"replicates: 0\n", {"sweep.yaml:3:13: replicates: '0' is not allowed"}},
  };
  for (const auto& [lines, parts] : wrong) {
    const std::string complaint = complaint_of(lines);
    for (const std::string& part : parts) EXPECT_NE(complaint.find(part), std::string::npos) << lines << complaint;
    EXPECT_EQ(complaint.find('\n'), std::string::npos) << complaint;
  }
}

TEST(SweepSpec, OfASmallFileThatMeansAHugeOneIsRefusedAtOnce) {
  std::string items = "&a [1", many = "[*a";
  for (int i = 0; i < 9'000; ++i) {
    items += ", 1";
    many += ", *a";
  }
  for (const std::string& lines :
       {"sets: " + items + "]\naxes: {cores: " + many + "]}\n",
        "sets: " + items + "]\naxes: {a: {keys: [cores, tni.trvs], values: " + many + "]}}\n",
        "sets: " + items + "]\naxes: {a: {keys: *a, values: " + many + "]}}\n",
        "sets: " + items + "]\naxes: {cores: [1]}\nwhere: &w [{cores: *a}" +
            [] {
              std::string more;
              for (int i = 0; i < 9'000; ++i) more += ", {cores: *a}";
              return more;
            }() +
            "]\n"}) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_NE(complaint_of(lines), "");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  }
}

TEST(SweepSpec, OfAnotherSchemaOrNoneIsRefused) {
  const TempFolder folder;
  EXPECT_THROW(tools::sweep::read_spec(folder.write("a.yaml", "axes: {cores: [1]}\n")), std::exception);
  EXPECT_THROW(tools::sweep::read_spec(folder.write("b.yaml", "schema: raywatt-sweep/9\n")), std::exception);
}

// Tests that the id of a point does not depend on the points before it.

using namespace tools::sweep;

TEST(PointKeys, HashTheConfigurationThatARunOfThePointLoads) {
  const std::vector<Point> points = points_of(
      "sets: [tni.trv.rays=8]\n"
      "axes: {cores: [1, 2], tni.trv.l1.size: [4 KiB, 16 KiB], dram.extends: [dram/lpddr3-1600, dram/lpddr4-3200]}\n");
  ASSERT_EQ(points.size(), 8U);
  PointKeys keys;
  std::set<std::string> ids;
  for (const Point& point : points) {
    const tools::RunConfig loaded = tools::load_run_config(point.run_options());
    const PointKeys::Key key = keys.key_of(point);
    EXPECT_EQ(key.made_of["config_hash"], sim::config_hash(loaded));
    EXPECT_EQ(sim::config_hash(keys.config_of(point)), sim::config_hash(loaded));
    EXPECT_EQ(key.id, point.id);
    EXPECT_EQ(key.stream, point.stream);
    ids.insert(key.id);
  }
  EXPECT_EQ(ids.size(), points.size());
}

TEST(PointKeys, OfAPointAreTheSameAfterOthersAndAfterRefusals) {
  const std::vector<Point> points =
      points_of("axes: {cores: [1, 2, 4], tni.trv.l1.size: [4 KiB, 5 KiB, 16 KiB], l2.ways: [4, 8]}\n");
  for (const Point& point : points) {
    Point alone = point;
    PointKeys().set_key(alone);
    EXPECT_EQ(alone.id, point.id);
    EXPECT_EQ(alone.stream, point.stream);
    EXPECT_EQ(alone.error, point.error);
  }
}

}  // namespace
}  // namespace test
