#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "traces/raster/raster_config.h"
#include "traces/raster/raster_geometry.h"
#include "traces/raster/raster_view.h"
#include "traces/raster/triangle_lists.h"
#include "traces/ray.h"
#include "traces/stream.h"

namespace traces {

/// Findings of a rasteriser at the samples of a wave. Storage is used again.
struct Coverage {
  /// Winner of a sample: its nearest triangle.
  struct Winner {
    std::uint32_t triangle = kNone;  ///< among the frame's; kNone: nothing is there
    double depth = 0;
  };
  std::vector<Winner> winners;        ///< one of each sample, in their order
  std::vector<std::uint32_t> layers;  ///< triangles that cover it
  std::vector<std::uint32_t> quads;   ///< quads of triangles that had it in them

  // While a wave is made: samples by list, block and quad; blocks of a list; lists that triangles of a batch are in.
  struct Sample {
    std::uint32_t list = 0, block = 0, quad = 0, sample = 0;
    glm::dvec2 at{0};
  };
  struct Block {
    std::span<const Sample> samples;
    PictureBox box;
    double farthest = 0;  ///< depth behind which nothing of it can be seen
  };
  std::vector<Sample> samples;
  std::vector<Block> blocks;
  std::vector<std::uint32_t> touched;
};

/// A rasteriser as to what it does, not when: which samples each triangle covers, and which of them it wins. It makes
/// the work of a hardware unit (hw_models/raster); pictures take their hits from a Tracer, with which it agrees but for
/// samples on edges and surfaces at the same depth.
///
///   geometry pass: triangles, a batch at a time -> lists by part of the picture
///   a wave:        lists of the parts that its samples lie in -> blocks -> quads -> samples, nearest first
///
/// Samples lie wherever their rays cross the picture. Within a block, quads and samples that have none are passed over.
/// Not modelled: positions rounded to a grid of sub-pixels, as hardware has them; all arithmetic is in double
/// precision.
class Rasteriser {
 public:
  /// `side`: of the parts of the picture that have lists, in pixels. `image` need not outlive it. InputError if the
  /// lists grow too long.
  Rasteriser(const MemoryImage& image, const PictureCamera& camera, const RasterConfig& config, std::uint32_t side);
  Rasteriser(const Rasteriser&) = delete;
  Rasteriser& operator=(const Rasteriser&) = delete;

  RasterDemands demands() const;
  /// Pieces of the geometry pass.
  std::uint32_t batches() const { return (triangles() + config_.batch - 1) / config_.batch; }
  /// Appends the work of a batch, with the storage of `scratch`; returns how many triangles it has.
  std::uint32_t bin(std::uint32_t batch, Coverage& scratch, TileWork& work) const;
  /// Finds what rays from the eye meet first, and if `work` is not null appends the work of that.
  void cover(std::span<const Ray> rays, Coverage& found, TileWork* work) const;

  const RasterGeometry& geometry() const { return geometry_; }
  const RasterView& view() const { return view_; }

 private:
  std::uint32_t triangles() const { return static_cast<std::uint32_t>(geometry_.triangles.size()); }
  std::array<Projected, 3> corners(std::uint32_t triangle) const;
  void sort(std::span<const Ray> rays, Coverage& found) const;
  void cover_list(std::span<const Coverage::Sample> samples, Coverage& found, TileWork* work) const;

  const RasterConfig config_;
  const RasterGeometry geometry_;
  const RasterView view_;
  const double near_;
  const TriangleLists lists_;
};

}  // namespace traces
