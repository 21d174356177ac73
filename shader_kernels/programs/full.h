#pragma once
#include <cstdint>

#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/pixel_sink.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Frame program full:N: traces every sample of every pixel.
///
///   generate_rays -> Wavefront -> average_colour -> pack_colour -> transfer to the frame buffer
///
/// A tile is a square of whole pixels. It has at most the configured number of samples, but at least one pixel.
class FullProgram : public FrameProgram {
 public:
  /// `samples` is the number of samples per pixel, a square number. The image must outlive the program.
  /// `sink` receives the samples; null: pixels go to the frame buffer.
  FullProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
              std::uint32_t samples, std::uint32_t frame, const PixelSink* sink = nullptr);

  std::uint32_t tiles() const override { return tiles_across_ * tiles_down_; }  ///< tiles are numbered row by row
  TileGridSize tile_grid_size() const override { return {tiles_across_, tiles_down_}; }
  FrameRequirements requirements() const override;
  /// Returns the number of pixels in a full tile.
  std::uint32_t tile_pixels() const { return side_ * side_; }
  std::uint32_t tile_samples() const { return tile_pixels() * samples_; }

  void run_tile(std::uint32_t tile, const traces::Tracer& tracer, bool record, TileResult& out) const override;

 protected:
  const RenderConfig& config() const { return config_; }
  const SceneTables& scene() const { return scene_; }
  /// Traces and shades the primary rays of a tile, which launch `generated` made with the uniforms of `ports`. Keeps
  /// the records that `retained` selects.
  virtual void shade_rays(Wavefront& wave, const GeneratePorts<float>& ports, Wavefront::Node generated,
                          std::uint32_t samples, const RetainedRecords& retained) const;
  /// Launches the kernel that averages the samples of each pixel.
  virtual Wavefront::Node average_samples(TileGraph& graph, AverageColour::Ports<float>& ports,
                                          std::uint32_t samples) const;

 private:
  Wavefront::Node launch_rays(TileGraph& graph, GeneratePorts<float>& ports, std::uint32_t samples) const;
  /// Averages and encodes the pixels of a tile that has `samples` samples, and writes them to memory.
  void write_pixels(TileGraph& graph, std::uint32_t samples, TileResult& out) const;

  const RenderConfig config_;
  const SceneTables scene_;
  const CameraUniforms<float> camera_;
  const std::uint32_t samples_, grid_, frame_;
  const std::uint32_t side_;  ///< number of pixels along the side of a tile
  const std::uint32_t tiles_across_, tiles_down_;
  const std::uint32_t seed_;
  const PixelSink* const sink_;
};

}  // namespace kernels
