#pragma once
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "block_harness.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/programs.h"
#include "showcase.h"

namespace kernels {

using traces::Edge;
using traces::Region;
using traces::WorkNode;

struct Recorded {
  FrameRequirements requirements;
  std::vector<traces::TileWork> works;
  std::uint32_t count = 0, across = 0;  ///< number of tiles of the frame, and of a row
};

/// Base of tests of the work recorded by frame programs that sample in blocks.
class BlockStream : public testing::TestWithParam<const char*> {
 protected:
  static constexpr std::uint32_t kWidth = 75, kHeight = 41;  // not multiples of the tile: edge tiles are cut
  const ProgramSpec spec_ = parse_program(GetParam());
  const std::uint32_t grid_ = spec_.samples == 4 ? 2 : 1;
  ProgramConfig programs_;
  RenderConfig render_ = small(kWidth, kHeight);

  BlockStream() { programs_.undersample.correction = Correction::kFour; }
  void set(const AdaptiveConfig& adaptive) {
    static_cast<AdaptiveConfig&>(programs_.multirate) = adaptive;
    static_cast<AdaptiveConfig&>(programs_.undersample) = adaptive;
  }
  std::uint32_t record_bytes() const {
    if (spec_.kind == ProgramSpec::Kind::kMultirate) {
      return sizeof(GeometryRecord<float>) + sizeof(SecondaryRecord<float>);
    }
    return sizeof(GeometryRecord<float>) + sizeof(SurfaceRecord<float>) + sizeof(ColourRecord<float>);
  }
  Recorded record(const traces::Scene& scene) const {
    const Stage stage(scene);
    const RateMap rates(programs_.multirate);
    const auto program = make_program(spec_, {stage.image, stage.camera, render_, programs_, rates, 0});
    Recorded out{program->requirements(), run_program(*program, stage.tracer, grid_, true).works, 0, 0};
    out.count = program->pass_end(0);
    const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(out.requirements.tile_samples)));
    out.across = (kWidth * grid_ + side - 1) / side;
    return out;
  }
  static void for_each_scene(auto&& check) {
    check(showcase_scene());
    check(traces::open_scene("cornell"));
  }
  static std::string_view kernel(const WorkNode& node) {
    return node.kind == WorkNode::Kind::kLaunch ? kernel_catalogue()[node.kernel].name : "";
  }
  static bool moves(const WorkNode& node, Region region) {
    return node.kind == WorkNode::Kind::kTransfer && node.region == region;
  }
};
}  // namespace kernels
