#pragma once
#include <memory>

#include "shader_kernels/programs/wavefront/frame_program.h"
#include "traces/raster/rasteriser.h"

namespace kernels {

/// Wraps a frame program whose primary hits are found by rasterisation. Before the entries (mostly tiles) of that
/// program, a geometry pass adds all triangles to the triangle lists of screen regions.
///
///   pass 0: batches of triangles --> lists --> all later passes: the program's own, whose first waves are rasterised
///
/// Entries of the geometry pass render no pixels. They are numbered as tiles after those of the program.
class GeometryPass final : public FrameProgram {
 public:
  GeometryPass(std::unique_ptr<FrameProgram> program, std::unique_ptr<traces::Rasteriser> rasteriser,
               std::uint32_t frame);

  std::uint32_t tiles() const override { return batch_count() + program_->tiles(); }
  TileGridSize tile_grid_size() const override { return program_->tile_grid_size(); }
  std::uint32_t pass_end(std::uint32_t tile_index) const override;
  std::shared_ptr<const DenoiseHistory> make_history() const override { return program_->make_history(); }
  FrameRequirements requirements() const override;
  void begin_pass(std::uint32_t tile_index, const traces::Tracer& tracer) override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

  const std::vector<float>& picture() const override { return program_->picture(); }
  std::vector<float> move_picture_out() override { return program_->move_picture_out(); }
  const Sampling& sampling() const override { return program_->sampling(); }
  void enable_marks() override { program_->enable_marks(); }
  const std::vector<SampleMark>& sample_marks() const override { return program_->sample_marks(); }

 private:
  std::uint32_t batch_count() const { return rasteriser_->batch_count(); }
  void run_batch(std::uint32_t batch, bool record, TileResult& out) const;

  const std::unique_ptr<FrameProgram> program_;
  const std::unique_ptr<traces::Rasteriser> rasteriser_;
  const std::uint32_t frame_;
};

/// Returns a rasteriser for a picture that is divided into square tiles of `side` pixels.
std::unique_ptr<traces::Rasteriser> make_rasteriser(const traces::MemoryImage& image, const traces::Camera& camera,
                                                    std::uint32_t width, std::uint32_t height,
                                                    const traces::RasterConfig& config, std::uint32_t side);

}  // namespace kernels
