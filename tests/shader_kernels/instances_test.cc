#include <algorithm>
#include <cmath>
#include <string>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/programs.h"
#include "showcase.h"
#include "tests/param_name.h"

// Tests that scenes of instances render the same picture with a two-level tree as with a flat one.

namespace kernels {
namespace {

constexpr traces::BvhConfig kLevels{.instances = traces::InstanceLevels::kTwoLevel};

/// Returns the showcase with every object turned, stretched or mirrored in its own way.
traces::Scene placed_showcase() {
  traces::Scene scene = showcase_scene();
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    glm::mat4& at = scene.instances[i].to_world;
    const auto f = static_cast<float>(i);
    at = glm::rotate(at, 0.03F * f, glm::vec3(0, 1, 0));
    at = glm::scale(at, {i % 3 == 1 ? -1.0F : 1.0F, 0.8F + 0.05F * f, i % 2 == 0 ? 1.0F : 1.3F});
  }
  return scene;
}

RenderConfig picture_size() {
  RenderConfig config = small(96, 64);
  config.depth = 4;
  return config;
}

double psnr(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = double{std::clamp(a[i], 0.0F, 1.0F)} - std::clamp(b[i], 0.0F, 1.0F);
    sum += d * d;
  }
  return sum == 0 ? 200 : -10 * std::log10(sum / static_cast<double>(a.size()));
}

struct Shown {
  std::vector<float> rgb;
  Sampling sampling;
};

Shown show(const traces::Scene& scene, const std::string& program, const traces::BvhConfig& bvh) {
  const traces::MemoryImage image = traces::build_memory_image(scene, bvh, 1);
  const traces::BvhTracer tracer(image);
  const ProgramConfig programs;
  const RateMap rates(programs.multirate);
  const RenderConfig render = picture_size();
  const auto frame =
      make_program(parse_program(program), {image, scene.cameras.front(), render, programs, rates, 0, 6});
  run_tiles(*frame, tracer, true, [](const TileResult&) {});
  return {frame->picture(), frame->sampling()};
}

class InstancedProgram : public ::testing::TestWithParam<const char*> {};

TEST_P(InstancedProgram, ShowsTheFlattenedPicture) {
  const traces::Scene scene = placed_showcase();
  const Shown flat = show(scene, GetParam(), {}), levels = show(scene, GetParam(), kLevels);
  EXPECT_GT(psnr(flat.rgb, levels.rgb), 50);
  EXPECT_NEAR(static_cast<double>(levels.sampling.traced), static_cast<double>(flat.sampling.traced),
              0.005 * static_cast<double>(flat.sampling.traced));
}

INSTANTIATE_TEST_SUITE_P(All, InstancedProgram,
                         ::testing::Values("full:1", "multirate:under", "multirate:super", "undersample",
                                           "supersample"),
                         ::test::ParamName());

TEST(Instanced, AHitReadsTheRecordOfItsInstance) {
  const traces::Scene scene = placed_showcase();
  for (const bool levels : {false, true}) {
    const traces::MemoryImage image = traces::build_memory_image(scene, levels ? kLevels : traces::BvhConfig{}, 1);
    const traces::BvhTracer tracer(image);
    const RenderConfig config = picture_size();
    FullProgram program(image, scene.cameras.front(), config, 1, 0);
    TileResult tile;
    std::uint64_t records = 0, surfaces = 0;
    for (std::uint32_t t = 0; t < program.tiles(); ++t) {
      program.run_tile(t, tracer, true, tile);
      for (const traces::Access& access : tile.work.accesses) {
        if (access.kind() != traces::Access::Kind::kInstance) continue;
        records += 1;
        EXPECT_LT(access.element, scene.instances.size());
      }
      for (const traces::WorkNode& node : tile.work.nodes) {
        if (node.kind != traces::WorkNode::Kind::kLaunch) continue;
        const KernelInfo& kernel = kernel_catalogue()[node.kernel];
        const bool fetches = kernel.name == FetchVertices<true>::kName || kernel.name == ShadeSurface<true>::kName ||
                             std::ranges::count(kernel.parts, ShadeSurface<true>::kName) != 0;
        surfaces += fetches ? node.items : 0;
      }
    }
    EXPECT_EQ(records, surfaces) << "one for the normal, one for the tangent";
    EXPECT_EQ(records > 0, levels);
  }
}

/// A sphere stretched unevenly and mirrored, lit from the side. A normal transformed like a point would be wrong.
TEST(Instanced, NormalsUseTheInverseTranspose) {
  traces::Scene scene = empty_scene();
  traces::add_object(scene, traces::make_sphere("ball", {0, 0, 0}, 1, 40),
                     traces::add_material(scene, {.base_colour = glm::vec3(1)}));
  scene.instances[0].to_world = glm::scale(glm::mat4(1), {-2, 0.5F, 1});
  const glm::vec3 light = glm::normalize(glm::vec3(1, 1, 0.5F));
  scene.lights.push_back({.kind = traces::Light::Kind::kDirectional, .direction = -light, .intensity = glm::vec3(1)});
  const traces::MemoryImage image = traces::build_memory_image(scene, kLevels, 1);
  const traces::BvhTracer tracer(image);
  const traces::Camera camera = traces::look_at("front", {0.9F, 0.2F, 6}, {0.9F, 0.2F, 0}, 0.3F);
  const Picture picture = render(image, camera, tracer, small(1, 1));
  // On the ellipsoid x = 0.9, y = 0.2: z = sqrt(1 - 0.9^2 / 4 - 0.2^2 / 0.25), the normal is its gradient.
  const float z = std::sqrt(1 - 0.2025F - 0.16F);
  const glm::vec3 normal = glm::normalize(glm::vec3(0.9F / 4, 0.2F / 0.25F, z));
  EXPECT_NEAR(picture.at(0, 0).x, glm::dot(normal, light), 0.01F);
}

}  // namespace
}  // namespace kernels
