#include <gtest/gtest.h>

#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/host/build_info.h"
#include "tools/studies/sweep/launch/compute.h"
#include "tools/studies/sweep/spec/set_metric.h"

// Tests of the sweeps in configs/experiments.

namespace test {
namespace {

namespace fs = std::filesystem;
using namespace tools::sweep;

std::vector<fs::path> experiments() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(tools::build_info().source_dir) / "configs/experiments")) {
    if (read_bytes(entry.path()).starts_with("schema: raywatt-sweep/")) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

TEST(Experiments, EachHaveAQuestionAndSoundPoints) {
  ASSERT_GE(experiments().size(), 7U);
  for (const fs::path& file : experiments()) {
    const Spec spec = read_spec(file);
    EXPECT_TRUE(spec.question.ends_with("?")) << file;
    const std::vector<Point> points = plan_points(spec, file.parent_path());
    EXPECT_GE(points.size(), 10U) << file;
    // A set of workloads is simulated in minutes if its pictures are small.
    const auto set = std::ranges::find(spec.axes, kWorkloadAxis, &Axis::name);
    EXPECT_LE(points.size(), set == spec.axes.end() ? 40U : 100 * set->values.size()) << file;
    for (const Point& point : points) EXPECT_EQ(point.error, "") << file;
  }
}

TEST(Experiments, RunAtATinySize) {
  const TempFolder folder;
  const Store store(folder.path());
  PointKeys keys;
  PointComputer computer(store, 1);
  for (const fs::path& file : experiments()) {
    Point point = plan_points(read_spec(file), file.parent_path()).back();
    point.scene = "cornell";
    point.resolution = "16x16";
    keys.set_key(point);
    EXPECT_EQ(computer.compute_point(point, {}), PointStatus::kComputed)
        << file << ": " << (store.read_failure(point.id) ? store.read_failure(point.id)->error : "");
  }
}

}  // namespace
}  // namespace test
