#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/pixel_sink.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Frame program full:1 that traces effects at only some pixels (RenderConfig::effect_rate). First hits emit rays for
/// occlusion and soft shadows at only some pixels. A filter computes the effects at the other pixels
/// (docs/design/effects.md).
///
///   per tile: generate_centred_rays -> shading without these effects -> unblocked light of all samples, visible
///             fractions of some -> [halo] -> upsample_effects (per light) -> pack_grid_sample, or the sink
///
/// Each sample in the tile buffer is a pixel of the tile or its halo. Its data for light l are at its own index plus
/// l times the number of samples.
class UpsampledProgram final : public FrameProgram {
 public:
  /// `scene_size` is the longest side of the scene's bounds, the same in all frames. `sink` receives the pixels; null:
  /// they go to the frame buffer.
  UpsampledProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                   const ReconstructConfig& filter, float scene_size, std::uint32_t frame,
                   const PixelSink* sink = nullptr);

  /// Returns the tiles of a frame. Their sides are half those of other programs, because a sample keeps much data.
  static FinishedTiles tiles_of(const RenderConfig& config) {
    return {config.width, config.height, config.tile / 2, 1};
  }

  std::uint32_t tiles() const override { return tiles_.tile_count(); }
  TileGridSize tile_grid_size() const override {
    return {tiles_.sample_tiles().tiles_across(), tiles_.sample_tiles().tiles_down()};
  }
  FrameRequirements requirements() const override;
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;

 private:
  using Node = Wavefront::Node;
  /// State of a tile while UpsampledProgram renders it.
  struct Tile {
    SampleTile at;
    FinishedUniforms<float> finished;
    GridUniforms<float> grid;
    std::uint32_t pixels;  ///< number of pixels whose final colours the tile computes
    Wavefront& wave;
    TileGraph& graph;
    TileResult& out;
  };

  std::uint32_t buffer_position_count() const { return tiles_.buffer_sample_count(); }
  /// light_bytes_per_sample() returns the bytes of a sample's data for all lights. exchanged_bytes_per_sample() returns
  /// the mean bytes per border sample that a neighbouring tile reads.
  std::uint32_t light_bytes_per_sample() const;
  std::uint32_t exchanged_bytes_per_sample() const;
  std::uint64_t stored_bytes_per_tile() const { return tiles_.stored_samples() * exchanged_bytes_per_sample(); }
  /// Returns the address in region kSamples of the border samples of a tile.
  std::uint64_t stored_address(std::uint32_t tile) const {
    return (sink_ != nullptr ? sink_->memory_end() : 0) + stored_bytes_per_tile() * tile;
  }
  void trace_pixels(Tile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t across, std::uint32_t down) const;
  void take_bounce(Tile& tile, const LatticeUniforms<float>& lattice, std::uint32_t pixels) const;
  void fill_halo(Tile& tile) const;
  void export_borders(Tile& tile) const;
  void upsample_effects(Tile& tile) const;
  template <bool kCheckerboard>
  void upsample_effects(Tile& tile) const;
  /// Packs and writes the finished pixels.
  void write_finished(Tile& tile) const;

  const RenderConfig config_;
  const SceneTables scene_;
  const CameraUniforms<float> camera_;
  const FinishedTiles tiles_;
  const std::vector<std::uint32_t> order_;
  const std::uint32_t frame_, layers_;
  const float bend_;
  const EyeUniforms<float> eye_;
  const PixelSink* const sink_;
};

}  // namespace kernels
