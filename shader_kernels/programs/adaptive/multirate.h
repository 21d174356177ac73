#pragma once
#include <cstdint>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/adaptive/rate_map.h"

namespace kernels {

/// Frame programs multirate:under and multirate:super (Lee et al. 2016). A sample between similar references gets an
/// interpolated colour instead of rays. The program renders one sample per pixel, or four.
class MultirateProgram final : public FrameProgram {
 public:
  /// `samples_per_side` is the number of samples along the side of a pixel, 1 or 2. `rates` must not change while the
  /// program runs.
  MultirateProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                   const MultirateConfig& multirate, std::uint32_t samples_per_side, const RateMap& rates,
                   std::uint32_t frame);

  std::uint32_t tiles() const override { return blocks_.tiles.tile_count(); }
  TileGridSize tile_grid_size() const override { return {blocks_.tiles.tiles_across(), blocks_.tiles.tiles_down()}; }
  FrameRequirements requirements() const override { return blocks_.requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

 private:
  /// Checks samples for similarity, and interpolates the colours of those that pass.
  Verdict check_and_interpolate(BlockTile& tile, const BlockLines& lines) const;
  template <bool kAlongY, bool kSecondary, bool kTexture>
  Verdict check_and_interpolate(BlockTile& tile, const BlockLines& lines) const;

  const MultirateConfig multirate_;
  const BlockFrame blocks_;
  const bool secondary_checks_;
  const bool compares_colours_;  ///< the similarity checks include the colours of textured surfaces
  const RateMap& rates_;
};

}  // namespace kernels
