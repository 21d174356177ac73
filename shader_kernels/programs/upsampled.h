#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Frame program full:1 that traces effects at only some pixels (RenderConfig::effect_rate). First hits emit rays for
/// occlusion and soft shadows at only some pixels. A filter computes the effects at the other pixels
/// (docs/design/effects.md).
///
///   per tile: generate_centred_rays -> shading without these effects -> unblocked light of all samples, visible
///             fractions of some -> [halo] -> upsample_effects (per light) -> pack_grid_sample
///
/// Each sample in the tile buffer is a pixel of the tile or its halo. Its data for light l are at its own index plus
/// l times the number of samples.
class UpsampledProgram final : public FrameProgram {
 public:
  /// `scene_size` is the longest side of the scene's bounds, the same in all frames.
  UpsampledProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                   const ReconstructConfig& filter, float scene_size, std::uint32_t frame);

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
  void trace_pixels(Tile& tile, std::uint32_t x, std::uint32_t y, std::uint32_t across, std::uint32_t down) const;
  void take_bounce(Tile& tile, const LatticeUniforms<float>& lattice, std::uint32_t pixels) const;
  void fill_halo(Tile& tile) const;
  void export_borders(Tile& tile) const;
  Node upsample_effects(Tile& tile) const;
  template <bool kCheckerboard>
  Node upsample_effects(Tile& tile) const;
  /// Packs and writes the finished pixels after the launch `upsampled`.
  void write_finished(Tile& tile, Node upsampled) const;

  const RenderConfig config_;
  const SceneTables scene_;
  const CameraUniforms<float> camera_;
  const FinishedTiles tiles_;
  const std::vector<std::uint32_t> order_;
  const std::uint32_t frame_, layers_;
  const float bend_;
  const EyeUniforms<float> eye_;
};

}  // namespace kernels
