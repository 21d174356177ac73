#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/programs.h"
#include "tests/full_size.h"
#include "tests/shader_kernels/harness.h"
#include "tests/shader_kernels/showcase.h"
#include "traces/scenes/builtin.h"

// Tests that fused kernels change only the recorded work. Pictures, marks and rays are those of separate kernels.

namespace kernels {
namespace {

/// Pictures and recorded work of all frames that a program rendered.
struct Frames {
  std::vector<float> rgb;
  std::vector<std::vector<std::uint32_t>>
      packed;  ///< words written to the frame buffer by each tile, in dispatch order
  std::vector<std::vector<SampleMark>> marks;
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  Sampling sampling;
  std::uint64_t launches = 0, fused = 0;
  std::set<std::string_view> kernels;  ///< names of all kernels that were launched
};

Frames run(FrameProgram& program, const traces::Tracer& tracer) {
  Frames out;
  run_tiles(program, tracer, true, [&](const TileResult& tile) {
    out.packed.push_back(tile.packed);
    out.marks.push_back(tile.marks);
    for (std::size_t k = 0; k < out.rays.size(); ++k) out.rays[k] += tile.rays[k];
    for (const traces::WorkNode& node : tile.work.nodes) {
      if (node.kind != traces::WorkNode::Kind::kLaunch) continue;
      ++out.launches;
      out.kernels.insert(kernel_catalogue()[node.kernel].name);
      out.fused += kernel_catalogue()[node.kernel].parts.empty() ? 0U : 1U;
    }
  });
  out.rgb = program.picture();
  out.sampling = program.sampling();
  return out;
}

void expect_same(const Frames& fused, const Frames& apart) {
  EXPECT_EQ(fused.rgb, apart.rgb);
  EXPECT_EQ(fused.packed, apart.packed);
  EXPECT_EQ(fused.marks, apart.marks);
  EXPECT_EQ(fused.rays, apart.rays);
  EXPECT_EQ(fused.sampling.traced, apart.sampling.traced);
  EXPECT_EQ(fused.sampling.correction, apart.sampling.correction);
  EXPECT_EQ(fused.sampling.passed, apart.sampling.passed);
  EXPECT_EQ(fused.sampling.failed, apart.sampling.failed);
  EXPECT_EQ(fused.sampling.background, apart.sampling.background);
  EXPECT_LT(fused.launches, apart.launches);
  EXPECT_GT(fused.fused, 0U);
  EXPECT_EQ(apart.fused, 0U);
}

/// Compares the results of all programs with and without fusion on a scene.
void expect_fusion_to_change_nothing(const traces::Scene& scene, const traces::BvhConfig& bvh = {},
                                     ProgramConfig programs = {}, traces::MipMaps mip_maps = traces::MipMaps::kOn) {
  const traces::MemoryImage image = traces::build_memory_image(scene, bvh, 0, nullptr, mip_maps);
  const traces::BvhTracer tracer(image);
  const glm::vec3 sides = image.upper - image.lower;
  const float size = std::max({sides.x, sides.y, sides.z});
  programs.undersample.correct_shadows = true;
  const RateMap rates(programs.multirate);
  for (const char* name : {"full:1", "full:4", "multirate:under", "multirate:super", "undersample", "supersample",
                           "reconstruct", "reconstruct:sraa"}) {
    for (const Streams streams : {Streams::kCompacted, Streams::kDivergent}) {
      SCOPED_TRACE(testing::Message() << name << (streams == Streams::kDivergent ? ", divergent" : ""));
      RenderConfig render = small(64, 32);
      render.streams = streams;
      const auto frames = [&](Fusion fusion) {
        render.fusion = fusion;
        const Frame frame{image, scene.cameras.front(), render, programs, rates, 0, size};
        return run(*make_program(parse_program(name), frame), tracer);
      };
      expect_same(frames(Fusion::kOn), frames(Fusion::kOff));
    }
  }
}

TEST(FusedKernels, CheckGlobalColoursOnlyInTilesThatHaveSome) {
  const traces::Scene scene = traces::open_scene("cornell");  // its lamp glows, most of its tiles are matt
  const traces::MemoryImage image = traces::build_memory_image(scene, {});
  const ProgramConfig programs;
  const RateMap rates(programs.multirate);
  const auto launched = [&](Fusion fusion) {
    RenderConfig render = small(64, 32);
    render.fusion = fusion;
    const Frame frame{image, scene.cameras.front(), render, programs, rates, 0, 1};
    return run(*make_program(parse_program("undersample"), frame), traces::BvhTracer(image)).kernels;
  };
  EXPECT_TRUE(launched(Fusion::kOn).contains("check_attributes_x_local_untextured"));
  EXPECT_TRUE(launched(Fusion::kOn).contains("check_attributes_y_untextured"));
  EXPECT_TRUE(launched(Fusion::kOn).contains("count_coloured")) << "samples of neighbours count, too";
  EXPECT_FALSE(launched(Fusion::kOff).contains("check_attributes_x_local_untextured"));
}

class FusedKernelsOf : public testing::TestWithParam<std::string> {};
/// Returns all built-in scenes at full size, otherwise the small ones.
std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    if (scene.triangles <= test::full_or(10'000'000U, 60'000U)) names.emplace_back(scene.name);
  }
  return names;
}
INSTANTIATE_TEST_SUITE_P(BuiltIn, FusedKernelsOf, testing::ValuesIn(scene_names()),
                         [](const auto& i) { return i.param; });

TEST_P(FusedKernelsOf, MakeThePictureOfTheirParts) { expect_fusion_to_change_nothing(traces::open_scene(GetParam())); }

TEST(FusedKernels, MakeThePictureOfTheirPartsInTheShowcase) {
  expect_fusion_to_change_nothing(showcase_scene());
  expect_fusion_to_change_nothing(showcase_scene(), {}, {}, traces::MipMaps::kOff);
}

TEST(FusedKernels, MakeThePictureOfTheirPartsWithOptionalChecks) {
  ProgramConfig programs;
  programs.multirate.texture = 0.1;
  programs.undersample.samples = 4;
  programs.supersample.propagate = 2;
  expect_fusion_to_change_nothing(showcase_scene(), {}, programs);
}

TEST(FusedKernels, MakeThePictureOfTheirPartsWithInstances) {
  traces::BvhConfig bvh;
  bvh.instances = traces::InstanceLevels::kTwoLevel;
  expect_fusion_to_change_nothing(showcase_scene(), bvh);
  expect_fusion_to_change_nothing(traces::open_scene("cornell"), bvh);
}

}  // namespace
}  // namespace kernels
