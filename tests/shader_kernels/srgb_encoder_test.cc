#include <algorithm>
#include <string_view>

#include <gtest/gtest.h>

#include "block_harness.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/programs.h"
#include "showcase.h"

// Tests that the DMA encodes pixels to sRGB as the kernel does.

namespace kernels {
namespace {

struct EncodedFrame {
  std::vector<float> linear;
  std::vector<std::uint32_t> packed;  ///< words of the frame buffer, tile by tile
  std::uint64_t packing_items = 0, launches = 0, picture_bytes = 0;
};

class SrgbEncoders : public testing::TestWithParam<const char*> {
 protected:
  EncodedFrame run(SrgbEncoder srgb, Fusion fusion) const {
    RenderConfig render = small(37, 23);
    render.srgb = srgb;
    render.fusion = fusion;
    const ProgramConfig programs;
    const RateMap rates(programs.multirate);
    const auto program =
        make_program(parse_program(GetParam()), {stage_.image, stage_.camera, render, programs, rates, 0, 6});
    EncodedFrame frame;
    run_tiles(*program, stage_.tracer, true, [&](const TileResult& tile) {
      frame.packed.insert(frame.packed.end(), tile.packed.begin(), tile.packed.end());
      for (const traces::WorkNode& node : tile.work.nodes) {
        if (node.kind == traces::WorkNode::Kind::kLaunch) {
          frame.launches += 1;
          if (kernel_catalogue()[node.kernel].name.starts_with("pack_") &&
              !kernel_catalogue()[node.kernel].name.starts_with("pack_subpixels")) {
            frame.packing_items += node.items;
          }
        } else if (node.kind == traces::WorkNode::Kind::kTransfer && node.region == traces::Region::kPicture) {
          frame.picture_bytes += node.items;
        }
      }
    });
    frame.linear = program->picture();
    return frame;
  }
  const Stage stage_{showcase_scene()};
};

TEST_P(SrgbEncoders, GiveThePictureBitForBitAndTheDmaWithoutAKernel) {
  for (const Fusion fusion : {Fusion::kOff, Fusion::kOn}) {
    const EncodedFrame kernel = run(SrgbEncoder::kKernel, fusion), dma = run(SrgbEncoder::kDma, fusion);
    EXPECT_EQ(dma.packed, kernel.packed);
    EXPECT_EQ(dma.linear, kernel.linear);
    EXPECT_EQ(dma.picture_bytes, kernel.picture_bytes);
    EXPECT_GE(kernel.packing_items, 37U * 23U);
    EXPECT_EQ(dma.packing_items, 0U);
    if (fusion == Fusion::kOff) {
      EXPECT_LT(dma.launches, kernel.launches);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Programs, SrgbEncoders,
                         testing::Values("full:1", "full:4", "multirate:under", "multirate:super", "undersample",
                                         "supersample"),
                         [](const auto& i) {
                           std::string name(i.param);
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

}  // namespace
}  // namespace kernels
