#include <algorithm>

#include <gtest/gtest.h>

#include "tools/analysis/picture.h"
#include "traces/accel/build.h"
#include "traces/scenes/library.h"

namespace tools {
namespace {

TEST(RasterPictures, ShowOverdrawInsideOfQuads) {
  const traces::Scene scene = traces::open_scene("cornell");
  const traces::MemoryImage image = traces::build_memory_image(scene, {}, 1);
  kernels::RenderConfig render;
  render.width = 63;
  render.height = 31;
  render.tile = 8;
  const std::vector<DebugPicture> pictures = raster_pictures(image, scene.cameras.front(), render);
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_EQ(pictures[0].name, "overdraw");
  EXPECT_EQ(pictures[1].name, "quads");
  std::size_t seen = 0;
  for (std::size_t i = 0; i < std::size_t{63} * 31; ++i) {
    const auto is_black = [&](const DebugPicture& p) {
      return p.rgb.at(3 * i) == 0 && p.rgb.at(3 * i + 1) == 0 && p.rgb.at(3 * i + 2) == 0;
    };
    seen += !is_black(pictures[0]);
    if (!is_black(pictures[0])) {
      EXPECT_FALSE(is_black(pictures[1])) << "what covers a pixel covers its quad";
    }
  }
  EXPECT_GT(seen, std::size_t{63} * 31 / 2);
}

}  // namespace
}  // namespace tools
