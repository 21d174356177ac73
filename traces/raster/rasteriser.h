#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "traces/raster/raster_config.h"
#include "traces/raster/raster_view.h"
#include "traces/raster/triangle_lists.h"
#include "traces/ray.h"
#include "traces/stream.h"

namespace traces {

/// Result of rasterising the samples of a wave: for each sample, the nearest triangle and counts of work. The storage
/// is reused from wave to wave.
struct Coverage {
  /// The nearest triangle at a sample of a rasterised wave.
  struct NearestTriangle {
    std::uint32_t triangle = kNone;  ///< index of the triangle in the frame; kNone if no triangle covers the sample
    double depth = 0;
  };
  std::vector<NearestTriangle> winners;  ///< nearest triangle, one entry per sample
  std::vector<std::uint32_t> layers;     ///< for each sample, the number of triangles that cover it
  std::vector<std::uint32_t> quads;      ///< for each sample, the number of triangles that cover part of its quad

  // Scratch data of the rasteriser: samples sorted by triangle list, block and quad; blocks of one list; numbers of the
  // lists to which a batch adds triangles.
  struct Sample {
    std::uint32_t list = 0, block = 0, quad = 0, sample = 0;
    glm::dvec2 at{0};
  };
  struct Block {
    std::span<const Sample> samples;
    PictureBox box;
    double farthest = 0;  ///< triangles beyond this depth are hidden in the whole block
  };
  std::vector<Sample> samples;
  std::vector<Block> blocks;
  std::vector<std::uint32_t> touched;
};

/// Functional rasteriser: finds which samples each triangle covers and which triangle is nearest at each sample. It
/// determines the work of the hardware unit in hw_models/raster.
///
///   geometry pass: triangles, one batch after the other -> triangle lists of screen regions
///   a wave:        lists of the regions that contain its samples -> blocks -> quads -> samples, nearest first
///
/// 1. A sample is at the pixel position of its ray. Quads and blocks without samples are skipped.
/// 2. The hits of the picture come from a Tracer. The rasteriser finds the same hits, except for samples on edges and
///    surfaces at the same depth.
///
/// Not modelled: hardware rounds positions to a sub-pixel grid. Here all arithmetic is in double precision.
class Rasteriser {
 public:
  /// Projects the scene and builds the triangle lists. Each list belongs to a screen region of `side` x `side` pixels.
  /// `image` need not outlive the rasteriser. Throws InputError if the lists become too long.
  Rasteriser(const MemoryImage& image, const PictureCamera& camera, const RasterConfig& config, std::uint32_t side);
  Rasteriser(const Rasteriser&) = delete;
  Rasteriser& operator=(const Rasteriser&) = delete;

  RasterArraySizes raster_array_sizes() const;
  /// Returns the number of batches of triangles in the geometry pass.
  std::uint32_t batch_count() const { return (triangle_count() + config_.batch - 1) / config_.batch; }
  /// Appends the work of binning a batch of triangles, and returns the number of triangles. `scratch` provides storage.
  std::uint32_t bin_triangles(std::uint32_t batch, Coverage& scratch, TileWork& work) const;
  /// Finds the first hit of each ray from the eye. Appends the rasterisation work to `work` unless it is null.
  void rasterise_samples(std::span<const Ray> rays, Coverage& found, TileWork* work) const;

  const RasterGeometry& scene_geometry() const { return geometry_; }
  const RasterView& raster_view() const { return view_; }

 private:
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(geometry_.triangles.size()); }
  std::array<Projected, 3> project_corners(std::uint32_t triangle) const;
  void sort_samples(std::span<const Ray> rays, Coverage& found) const;
  void find_coverage_in_list(std::span<const Coverage::Sample> samples, Coverage& found, TileWork* work) const;

  const RasterConfig config_;
  const RasterGeometry geometry_;
  const RasterView view_;
  const double near_;
  const TriangleLists lists_;
};

}  // namespace traces
