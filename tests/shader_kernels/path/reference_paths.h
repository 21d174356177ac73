#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/path/path_config.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"

namespace kernels {

/// Sums of the samples of one pixel, from which mean and variance follow.
struct PixelSums {
  glm::dvec3 sum{0}, squares{0};
  std::uint32_t samples = 0;
  void add(const glm::dvec3& sample) {
    sum += sample;
    squares += sample * sample;
    samples += 1;
  }
};

/// Path tracer for tests: the integrand of the program path:N (docs/paths.md) in double precision, with Embree.
///
/// 1. It shares no code with the kernels: it has its own loop, random numbers and ways to sample. It casts rays to all
///    lights, chooses lobes with equal probabilities, samples all facets instead of visible ones, and plays no
///    roulette.
/// 2. Scenes are one-level images without mip maps. Materials have no details other than absorption, and no alpha.
///    Glass blocks shadow rays. Other scenes throw std::invalid_argument.
class ReferencePaths {
 public:
  /// All arguments must outlive the object.
  ReferencePaths(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                 const PathConfig& path);
  /// Traces `samples` paths through random points of each pixel. Returns the pixels row by row.
  std::vector<PixelSums> render(std::uint32_t samples, std::uint32_t seed);
  /// Returns the light that one path of up to RenderConfig::depth rays brings.
  glm::dvec3 trace_path(glm::dvec3 origin, glm::dvec3 direction);

 private:
  struct Surface;
  double random() { return uniform_(numbers_); }
  traces::Hit trace_ray(const glm::dvec3& origin, const glm::dvec3& direction, double t_min, double t_max,
                        traces::RayKind kind) const;
  Surface fetch_surface(const traces::Hit& hit, const glm::dvec3& origin, const glm::dvec3& direction) const;
  glm::dvec3 base_texel(std::uint32_t texture, double u, double v) const;
  glm::dvec3 direct_light(const Surface& surface, const glm::dvec3& direction) const;
  bool continue_path(const Surface& surface, glm::dvec3& direction, glm::dvec3& throughput, bool& scattered);

  const traces::MemoryImage& image_;
  const traces::Camera& camera_;
  const RenderConfig& config_;
  const PathConfig& path_;
  const traces::EmbreeTracer embree_;
  const double epsilon_;
  std::mt19937_64 numbers_;
  std::uniform_real_distribution<double> uniform_{0, 1};
};

}  // namespace kernels
