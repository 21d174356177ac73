#pragma once
#include <cstdint>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/adaptive/rate_map.h"

namespace kernels {

/// Frame programs multirate:under and multirate:super (Lee et al. 2016): samples between similar references get an
/// interpolated colour. A sample is a pixel, or one of four per pixel.
class MultirateProgram final : public FrameProgram {
 public:
  /// `grid`: samples along a pixel's side, 1 or 2. `rates` must not change while the program is in use.
  MultirateProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                   const MultirateConfig& multirate, std::uint32_t grid, const RateMap& rates, std::uint32_t frame);

  std::uint32_t tiles() const override { return blocks_.tiles.count(); }
  TileCounts tile_counts() const override { return {blocks_.tiles.tiles_across(), blocks_.tiles.tiles_down()}; }
  FrameRequirements requirements() const override { return blocks_.requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

 private:
  /// Checks samples, and interpolates the colour of those that pass.
  Verdict check_and_interpolate(BlockTile& tile, const BlockLines& lines) const;
  template <bool kAlongY, bool kSecondary, bool kTexture>
  Verdict check_and_interpolate(BlockTile& tile, const BlockLines& lines) const;

  const MultirateConfig multirate_;
  const BlockFrame blocks_;
  const bool secondary_checks_;
  const bool compares_colours_;  ///< colours of textured surfaces are checked
  const RateMap& rates_;
};

}  // namespace kernels
