#pragma once
#include <memory>

#include "shader_kernels/programs/leading_pass.h"
#include "traces/raster/rasteriser.h"

namespace kernels {

/// Wraps a frame program whose primary hits are found by rasterisation. Before the entries of that program, a geometry
/// pass adds all triangles to the triangle lists of screen regions.
///
///   pass 0: batches of triangles --> lists --> all later passes: the program's own, whose first waves are rasterised
class GeometryPass final : public LeadingPass {
 public:
  GeometryPass(std::unique_ptr<FrameProgram> program, std::unique_ptr<traces::Rasteriser> rasteriser,
               std::uint32_t frame);

  FrameRequirements requirements() const override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;

 private:
  std::uint32_t leading_entries() const override { return rasteriser_->batch_count(); }
  void record_entry(std::uint32_t entry, StreamBuilder& stream, TileResult& out) const override;

  const std::unique_ptr<traces::Rasteriser> rasteriser_;
};

/// Returns a rasteriser for a picture that is divided into square tiles of `side` pixels.
std::unique_ptr<traces::Rasteriser> make_rasteriser(const traces::MemoryImage& image, const traces::Camera& camera,
                                                    std::uint32_t width, std::uint32_t height,
                                                    const traces::RasterConfig& config, std::uint32_t side);

}  // namespace kernels
