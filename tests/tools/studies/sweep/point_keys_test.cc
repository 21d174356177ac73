#include <set>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/studies/sweep/spec/point.h"

// Tests that the id of a point does not depend on the points before it.

namespace test {
namespace {

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
