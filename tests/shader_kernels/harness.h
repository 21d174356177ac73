#pragma once
#include <array>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "shader_kernels/programs/full.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/scene/cameras.h"
#include "traces/scenes/library.h"
#include "traces/scenes/modelling/shapes.h"

namespace kernels {

/// A tracer that stores every ray it traces.
class SpyTracer : public traces::Tracer {
 public:
  explicit SpyTracer(const traces::Tracer& tracer) : tracer_(tracer) {}
  void trace(std::span<const traces::Ray> rays, traces::RayKind kind, std::span<traces::Hit> hits,
             traces::WalkSink* walk) const override {
    auto& seen = seen_[static_cast<std::size_t>(kind)];
    seen.insert(seen.end(), rays.begin(), rays.end());
    tracer_.trace(rays, kind, hits, walk);
  }
  const std::vector<traces::Ray>& seen(traces::RayKind kind) const { return seen_[static_cast<std::size_t>(kind)]; }

 private:
  const traces::Tracer& tracer_;
  mutable std::array<std::vector<traces::Ray>, static_cast<std::size_t>(traces::RayKind::kCount)> seen_;
};

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  glm::vec3 at(std::uint32_t x, std::uint32_t y) const {
    const float* p = rgb.data() + std::size_t{3} * (std::size_t{y} * width + x);
    return {p[0], p[1], p[2]};
  }
};

/// Runs a frame program for a whole frame, and calls `see` with each tile's result after it is committed.
inline void run_tiles(FrameProgram& program, const traces::Tracer& tracer, bool record, auto&& see) {
  TileResult tile;
  std::uint32_t pass_end = 0;
  for (std::uint32_t t = 0; t < program.tiles(); ++t) {
    if (t == pass_end) {
      program.begin_pass(t, tracer);
      pass_end = program.pass_end(t);
    }
    program.run_tile(t, tracer, record, tile);
    program.commit_tile(tile);
    see(tile);
  }
}

inline Picture render(const traces::MemoryImage& image, const traces::Camera& camera, const traces::Tracer& tracer,
                      const RenderConfig& config, std::uint32_t samples = 1, bool record = false) {
  FullProgram program(image, camera, config, samples, 0);
  Picture picture{program.width(), program.height(), {}, {}};
  run_tiles(program, tracer, record, [&](const TileResult& tile) {
    for (std::size_t k = 0; k < picture.rays.size(); ++k) picture.rays[k] += tile.rays[k];
  });
  picture.rgb = program.picture();
  return picture;
}

/// Returns an empty, black, unlit scene.
inline traces::Scene empty_scene() {
  traces::Scene scene;
  scene.background = scene.ambient = glm::vec3(0);
  return scene;
}

/// Adds a square of side `side` in the plane z = `z` that faces +z.
inline void add_wall(traces::Scene& scene, float z, float side, const traces::Material& material) {
  const float h = 0.5F * side;
  traces::add_object(scene, traces::make_quad("wall", {-h, -h, z}, {side, 0, 0}, {0, side, 0}, 1),
                     traces::add_material(scene, material));
}

inline RenderConfig small(std::uint32_t width, std::uint32_t height) {
  RenderConfig config;
  config.width = width;
  config.height = height;
  return config;
}

/// A rendered view of `scene` from `eye` towards `target`, with all rays that were traced.
struct View {
  View(const traces::Scene& scene, const glm::vec3& eye, const glm::vec3& target, RenderConfig config = small(9, 9))
      : image(traces::build_memory_image(scene, {}, 1)),
        tracer(image),
        spy(tracer),
        camera(traces::look_at("view", eye, target, 0.5F)),
        picture(render(image, camera, spy, config)) {}
  glm::vec3 centre() const { return picture.at(picture.width / 2, picture.height / 2); }

  const traces::MemoryImage image;
  const traces::BvhTracer tracer;
  const SpyTracer spy;
  const traces::Camera camera;
  const Picture picture;
};

inline void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

}  // namespace kernels
