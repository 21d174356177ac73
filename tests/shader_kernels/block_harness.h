#pragma once
#include <algorithm>
#include <vector>

#include "harness.h"
#include "shader_kernels/programs/adaptive/multirate.h"
#include "shader_kernels/programs/adaptive/undersample.h"

namespace kernels {

/// Findings of a frame program, and the work it has written down.
struct Sampled {
  std::vector<float> rgb;
  Sampling sampling;
  std::vector<SampleMark> marks;  ///< per sample of the picture's grid, row by row
  std::uint32_t samples_across = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::vector<traces::TileWork> works;  ///< in the order of the list, if recorded
  SampleMark mark(std::uint32_t x, std::uint32_t y) const { return marks[std::size_t{y} * samples_across + x]; }
};

/// Runs a frame program to its end; `grid`: samples along a pixel.
inline Sampled run_program(FrameProgram& program, const traces::Tracer& tracer, std::uint32_t grid = 1,
                           bool record = false) {
  Sampled out;
  out.samples_across = program.width() * grid;
  out.marks.resize(std::size_t{out.samples_across} * program.height() * grid);
  run_tiles(program, tracer, record, [&](const TileResult& tile) {
    for (std::size_t k = 0; k < out.rays.size(); ++k) out.rays[k] += tile.rays[k];
    for (std::size_t i = 0; i < tile.marks.size(); ++i) {
      const std::size_t x = tile.x * grid + i % (tile.width * grid), y = tile.y * grid + i / (tile.width * grid);
      out.marks[y * out.samples_across + x] = tile.marks[i];
    }
    if (record) out.works.push_back(tile.work);
  });
  out.rgb = program.picture();
  out.sampling = program.sampling();
  return out;
}

/// A scene ready to be sampled by any method.
struct Stage {
  Stage(const traces::Scene& scene, const traces::Camera& view, traces::MipMaps mip_maps = traces::MipMaps::kOff)
      : image(traces::build_memory_image(scene, {}, 1, nullptr, mip_maps)), tracer(image), camera(view) {}
  explicit Stage(const traces::Scene& scene, traces::MipMaps mip_maps = traces::MipMaps::kOff)
      : Stage(scene, scene.cameras.front(), mip_maps) {}

  Sampled full(const RenderConfig& render, std::uint32_t samples = 1) const {
    FullProgram program(image, camera, render, samples, 0);
    return run_program(program, tracer);
  }
  /// With every tile at the rate of the first frame, unless `rates` says otherwise.
  Sampled multirate(const RenderConfig& render, const MultirateConfig& config, std::uint32_t grid = 1,
                    bool record = false, const RateMap* rates = nullptr) const {
    const RateMap first(config);
    MultirateProgram program(image, camera, render, config, grid, rates != nullptr ? *rates : first, 0);
    return run_program(program, tracer, grid, record);
  }
  Sampled undersample(const RenderConfig& render, const UndersampleConfig& config, bool record = false) const {
    UndersampleProgram program(image, camera, render, config, size(), 0);
    return run_program(program, tracer, config.grid(), record);
  }

  /// Longest side of the scene's bounds.
  float size() const {
    const glm::vec3 sides = image.upper - image.lower;
    return std::max({sides.x, sides.y, sides.z});
  }

  const traces::MemoryImage image;
  const traces::BvhTracer tracer;
  const traces::Camera camera;
};

inline void expect_equal(const Sampling& a, const Sampling& b) {
  EXPECT_EQ(a.wanted, b.wanted);
  EXPECT_EQ(a.traced, b.traced);
  EXPECT_EQ(a.halo, b.halo);
  EXPECT_EQ(a.correction, b.correction);
  EXPECT_EQ(a.background, b.background);
  EXPECT_EQ(a.traced_background, b.traced_background);
  EXPECT_EQ(a.checked, b.checked);
  EXPECT_EQ(a.passed, b.passed);
  EXPECT_EQ(a.failed, b.failed);
  EXPECT_EQ(a.similar, b.similar);
  EXPECT_EQ(a.blocks, b.blocks);
}

}  // namespace kernels
