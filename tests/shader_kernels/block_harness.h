#pragma once
#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "harness.h"
#include "shader_kernels/programs/adaptive/multirate.h"
#include "shader_kernels/programs/adaptive/undersample.h"

namespace kernels {

/// Results of a frame program for one frame, and its recorded work.
struct Sampled {
  std::vector<float> rgb;
  Sampling sampling;
  std::vector<SampleMark> marks;  ///< marks of all samples of the picture, row by row
  std::uint32_t samples_across = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::vector<traces::TileWork> works;  ///< work of each tile in dispatch order, if recorded
  SampleMark mark(std::uint32_t x, std::uint32_t y) const { return marks[std::size_t{y} * samples_across + x]; }
};

/// Runs a frame program for a whole frame. `grid`: samples of a pixel along each axis.
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

/// A scene with a camera, and functions to render it with each frame program.
struct Stage {
  Stage(const traces::Scene& scene, const traces::Camera& view, traces::MipMaps mip_maps = traces::MipMaps::kOff)
      : image(traces::build_memory_image(scene, {}, 1, nullptr, mip_maps)), tracer(image), camera(view) {}
  explicit Stage(const traces::Scene& scene, traces::MipMaps mip_maps = traces::MipMaps::kOff)
      : Stage(scene, scene.cameras.front(), mip_maps) {}

  Sampled full(const RenderConfig& render, std::uint32_t samples = 1) const {
    FullProgram program(image, camera, render, samples, 0);
    return run_program(program, tracer);
  }
  /// Renders with the program `multirate`. If `rates` is null, all tiles have the rate of a first frame.
  Sampled multirate(const RenderConfig& render, const MultirateConfig& config, std::uint32_t grid = 1,
                    bool record = false, const RateMap* rates = nullptr) const {
    const RateMap first(config);
    MultirateProgram program(image, camera, render, config, grid, rates != nullptr ? *rates : first, 0);
    return run_program(program, tracer, grid, record);
  }
  Sampled undersample(const RenderConfig& render, const UndersampleConfig& config, bool record = false) const {
    UndersampleProgram program(image, camera, render, config, size(), 0);
    return run_program(program, tracer, config.pixel_grid_side(), record);
  }

  /// Returns the longest side of the scene's bounds.
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

using traces::Material;
using Names = std::set<std::string_view>;

/// Returns the names of the similarity checks that failed for any block, except for the picture's edge.
inline Names failing(const Sampling& sampling) {
  Names names;
  for (std::size_t check = 0; check < sampling.failed.size(); ++check) {
    if (sampling.failed[check] != 0) names.insert(names_of(Check{})[check]);
  }
  names.erase("border");
  return names;
}

inline std::uint64_t failed(const Sampling& sampling, Check check) {
  return sampling.failed[static_cast<std::size_t>(check)];
}

/// Builds a scene of size 20 that is viewed from z = 4.
struct Room {
  traces::Scene scene = empty_scene();
  Room() { scene.ambient = glm::vec3(1); }
  /// Adds mesh `part` with `material` to the scene as one object.
  Room& add(const traces::Mesh& part, const Material& material = {}) {
    traces::add_object(scene, part, traces::add_material(scene, material));
    return *this;
  }
  Stage stage() const { return Stage(scene, traces::look_at("c", {0, 0, 4}, {0, 0, 0}, 0.5F)); }
  Sampling under(const UndersampleConfig& config = {}) const {
    return stage().undersample(small(16, 16), config).sampling;
  }
  Sampling multi(const MultirateConfig& config = {}) const { return stage().multirate(small(16, 16), config).sampling; }
};

/// Returns the part of the plane z = `z` from x = `left` to `right`, facing +z.
inline traces::Mesh sheet(float left, float right, float z = 0) {
  return traces::make_quad("sheet", {left, -10, z}, {right - left, 0, 0}, {0, 20, 0}, 1);
}

/// Joins the meshes left and right of x = 0 to one object. `left` must not have smooth normals at x = 0.
inline traces::Mesh join_meshes(traces::Mesh left, const traces::Mesh& right) {
  traces::append_mesh(left, right);
  return left;
}

/// Returns a surface with an edge at x = 0, which rises towards the viewer by `rise` (below 0: falls away).
inline traces::Mesh fold(float rise) {
  return join_meshes(traces::make_quad("left", {-10, -10, -10 * rise}, {10, 0, 10 * rise}, {0, 20, 0}, 1),
                     traces::make_quad("right", {0, -10, 0}, {10, 0, -10 * rise}, {0, 20, 0}, 1));
}

/// Returns a mirror in the plane z = 0, which shows objects behind the viewer.
inline Room mirror() {
  Room room;
  room.add(traces::make_quad("mirror", {-1.5F, -1.5F, 0}, {3, 0, 0}, {0, 3, 0}, 1),
           {.base_colour = glm::vec3(0), .mirror = 1});
  return room;
}

/// Returns the part of the plane z = 8 from x = `left` to `right`, facing -z.
inline traces::Mesh behind(float left, float right) {
  return traces::make_quad("behind", {right, -10, 8}, {left - right, 0, 0}, {0, 20, 0}, 1);
}

}  // namespace kernels
