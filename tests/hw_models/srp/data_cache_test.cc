#include "hw_models/srp/data_cache.h"

#include <vector>

#include <gtest/gtest.h>

namespace hw {
namespace {

std::vector<Addr> lines(std::uint32_t triangle, const traces::Layout& layout) {
  const LineSet set = lines_of_access(traces::Access::of_kind(traces::Access::Kind::kTriangle, triangle), layout);
  return {set.line, set.line + set.count};
}

TEST(DataCache, ATriangleOf48BytesIsOneLineOrTwo) {
  traces::Layout layout;
  layout.triangles = 1024;
  EXPECT_EQ(lines(0, layout), (std::vector<Addr>{1024}));
  EXPECT_EQ(lines(1, layout), (std::vector<Addr>{1024, 1088})) << "bytes 48 to 95";
}

TEST(DataCache, ATriangleOf36BytesIsItsVerticesAndItsLabel) {
  traces::Layout layout;
  layout.triangle_bytes = 36;
  layout.triangles = 1024;
  layout.labels = 4096;
  layout.separate_labels = true;
  EXPECT_EQ(lines(0, layout), (std::vector<Addr>{1024, 4096}));
  EXPECT_EQ(lines(3, layout), (std::vector<Addr>{1088, 1152, 4096})) << "vertices 108 to 143";
  EXPECT_EQ(lines(5, layout), (std::vector<Addr>{1152, 1216, 4096, 4160})) << "vertices 180 to 215, label 60 to 71";
}

TEST(DataCache, AWordOfRegionSamplesIsOneLine) {
  const auto access = traces::Access::of_kind(traces::Access::Kind::kStored, 17);
  const LineSet set = lines_of_access(access, {}, 4096);
  ASSERT_EQ(set.count, 1U);
  EXPECT_EQ(set.line[0], 4160U) << "bytes 68 to 71 of the region";
}

}  // namespace
}  // namespace hw
