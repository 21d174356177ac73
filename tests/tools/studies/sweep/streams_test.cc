#include <gtest/gtest.h>

#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/studies/sweep/launch/compute.h"
#include "tools/studies/sweep/launch/launcher.h"

// Tests that points which differ only in the machine share their recorded work.

namespace test {
namespace {

namespace fs = std::filesystem;
using namespace tools::sweep;

struct SweepStreams : testing::Test {
  TempFolder folder;
  Store store{folder.path() / "store"}, other{folder.path() / "other"};

  std::string report_in(const Store& where, const Point& point) {
    return comparable(nlohmann::json::parse(where.read_report(point.id).value())).dump();
  }
  /// Records the work of the first point, and expects that all points have the reports of points without a record.
  void expect_equal_reports_from_record(const std::vector<Point>& points) {
    PointComputer sharing(store, 1), alone(other, 1);
    EXPECT_EQ(sharing.compute_point(points[0], {.record = true}), PointStatus::kComputed);
    EXPECT_TRUE(fs::exists(store.stream_file(points[0].stream)));
    for (const Point& point : points) {
      EXPECT_EQ(point.stream, points[0].stream);
      sharing.compute_point(point, {});
      alone.compute_point(point, {});
      EXPECT_EQ(report_in(store, point), report_in(other, point));
    }
  }
};

TEST_F(SweepStreams, APlayedPointIsTheComputedOne) {
  const std::vector<Point> points =
      points_of("axes: {cores: [1, 2], tni.trv.stack_entries: [4, 8]}\nframes: 0:1\nreference: full:4\n");
  ASSERT_EQ(points.size(), 4U);
  expect_equal_reports_from_record(points);
  EXPECT_LT(nlohmann::json::parse(*store.read_report(points[1].id))["host"]["load_s"], 1e-2) << "without its scene";
}

TEST_F(SweepStreams, ReplicatesOfAPlayedPointAreThoseOfTheComputedOne) {
  const std::vector<Point> points = points_of("axes: {cores: [1, 2]}\nreplicates: 3\nreference: full:4\n");
  PointComputer sharing(store, 1), alone(other, 1);
  sharing.compute_point(points[0], {.record = true});
  sharing.compute_point(points[1], {});
  alone.compute_point(points[1], {});
  EXPECT_TRUE(fs::exists(store.stream_file(points[0].stream))) << "it was played";
  EXPECT_EQ(report_in(store, points[1]), report_in(other, points[1]));
  const auto replicates = nlohmann::json::parse(report_in(store, points[1]))["totals"]["replicates"];
  EXPECT_EQ(replicates["count"], 3);
  EXPECT_EQ(replicates["figures"]["cycles"]["values"].size(), 3U);
  EXPECT_EQ(replicates["figures"]["relative"]["speedup"]["values"].size(), 3U);
}

TEST_F(SweepStreams, SampledTilesOfARecordAreThoseOfTheRenderedFrame) {
  const std::vector<Point> points = points_of(
      "scene: teapot\naxes: {resolution: [320x320], tile: {keys: [cores, tni.trvs], values: [[1, 1], [1, 2], [2, "
      "4]]}}\n"
      "sets: [render.tile=8, frame.start=warm]\ntile_sampling: 5%\n");
  ASSERT_EQ(points.size(), 3U);
  expect_equal_reports_from_record(points);
  const auto sampled = nlohmann::json::parse(report_in(store, points[1]))["totals"]["sampled"];
  EXPECT_LT(sampled["timed"].get<int>(), 0.8 * sampled["tiles"].get<int>()) << "or this shows nothing";
  EXPECT_NE(points[0].stream, points_of("scene: teapot\nsets: [render.tile=8, frame.start=warm]\n")[0].stream);
}

TEST_F(SweepStreams, RepresentativeFramesAreComputedWithoutARecord) {
  const std::vector<Point> points = points_of(
      "scene: teapot\nframes: 0:5\nresolution: 32x32\naxes: {cores: [1, 2]}\n"
      "sets: [scene.camera_path=orbit, scene.orbit=180, scene.frame_rate=1]\nrepresentative: 2\n");
  PointComputer computer(store, 1);
  std::vector<nlohmann::json> sequences;
  for (const Point& point : points) {
    EXPECT_EQ(point.stream, "");
    EXPECT_EQ(computer.compute_point(point, {.record = true}), PointStatus::kComputed);
    const auto report = nlohmann::json::parse(report_in(store, point));
    EXPECT_EQ(report["totals"]["representative"]["frames"], 6);
    sequences.push_back(report["sequence"]);
  }
  EXPECT_EQ(sequences[0], sequences[1]) << "all machines simulate the same frames";
}

TEST_F(SweepStreams, ADamagedStreamIsThrownAway) {
  const std::vector<Point> points = points_of("axes: {cores: [1, 2]}\n");
  PointComputer computer(store, 1), alone(other, 1);
  computer.compute_point(points[0], {.record = true});
  fs::resize_file(store.stream_file(points[0].stream), 1000);
  EXPECT_EQ(computer.compute_point(points[1], {}), PointStatus::kComputed);
  EXPECT_FALSE(fs::exists(store.stream_file(points[0].stream)));
  alone.compute_point(points[1], {});
  EXPECT_EQ(report_in(store, points[1]), report_in(other, points[1]));
}

TEST_F(SweepStreams, OfABatchAreRecordedOnceAndRemovedAfterwards) {
  const std::vector<Point> points = points_of("axes: {program: [full:1, full:4], cores: [1, 2]}\nimage: no\n");
  const auto launcher = make_local_launcher(store, {.jobs = 1, .threads = 1});
  bool was_there = false;
  const BatchResult end = launcher->run(
      points, [&](std::size_t p, PointStatus) { was_there |= fs::exists(store.stream_file(points[p].stream)); });
  EXPECT_EQ(end.count_of(PointStatus::kComputed), 4U);
  EXPECT_TRUE(was_there);
  EXPECT_TRUE(names_in(store.root() / "streams").empty());
}

TEST_F(SweepStreams, AreRecordedForSampledTilesIfThatIsQuicker) {
  using tools::sweep::is_record_quicker;
  EXPECT_FALSE(is_record_quicker(4, 0.06)) << "chess, measured";
  EXPECT_TRUE(is_record_quicker(9, 0.06));
  EXPECT_FALSE(is_record_quicker(1, 1));
  EXPECT_TRUE(is_record_quicker(2, 0.6));
  const auto is_recorded = [&](const std::string& size, const std::string& axes) {
    const std::vector<Point> points = points_of("scene: teapot\nresolution: " + size + "\naxes: " + axes +
                                                "\nsets: [render.tile=8]\ntile_sampling: 1%\n");
    const auto launcher = make_local_launcher(store, {.jobs = 1, .threads = 1});
    bool was_there = false;
    launcher->run(points,
                  [&](std::size_t p, PointStatus) { was_there |= fs::exists(store.stream_file(points[p].stream)); });
    return was_there;
  };
  EXPECT_TRUE(is_recorded("192x192", "{tni.trvs: [1, 2]}")) << "of few tiles, most are sampled";
  EXPECT_FALSE(is_recorded("640x640", "{tni.trvs: [1, 2]}"));
}

TEST_F(SweepStreams, ALauncherTakesBatchAfterBatch) {
  const std::vector<Point> points = points_of("axes: {cores: [1, 2], tni.trvs: [1, 2]}\n");
  const auto launcher = make_local_launcher(store, {.jobs = 2, .threads = 1});
  EXPECT_EQ(launcher->run(std::span(points).first(2)).count_of(PointStatus::kComputed), 2U);
  const BatchResult second = launcher->run(points);
  EXPECT_EQ(second.statuses,
            (std::vector{PointStatus::kDone, PointStatus::kDone, PointStatus::kComputed, PointStatus::kComputed}));
  EXPECT_EQ(second.workers, 2U);
  EXPECT_GT(second.busy, 0);
  EXPECT_LE(second.busy, 1);
}

}  // namespace
}  // namespace test
