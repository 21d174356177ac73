#pragma once
#include <cstdint>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/block_tile.h"
#include "shader_kernels/programs/adaptive/rate_map.h"

namespace kernels {

/// Frame programs multirate:under and multirate:super (Lee et al. 2016): samples between similar ones take the colour
/// in their middle. A sample is a pixel, or one of four of a pixel.
class MultirateProgram final : public FrameProgram {
 public:
  /// `grid`: samples along a pixel, 1 or 2. `rates` must stay as they are while the program is in use.
  MultirateProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                   const MultirateConfig& multirate, std::uint32_t grid, const RateMap& rates, std::uint32_t frame);

  std::uint32_t tiles() const override { return blocks_.tiles.count(); }
  TileCounts tile_counts() const override { return {blocks_.tiles.across(), blocks_.tiles.down()}; }
  FrameRequirements requirements() const override { return blocks_.requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record, TileResult& out) const override;
  void commit_tile(const TileResult& tile) override;

 private:
  /// Checks samples and gives those that pass the colour between their references.
  Verdict check_and_interpolate(BlockTile& tile, const BlockLines& lines) const;
  template <bool kAlongY, bool kSecondary, bool kTexture>
  Verdict check_and_interpolate(BlockTile& tile, const BlockLines& lines) const;

  const MultirateConfig multirate_;
  const BlockFrame blocks_;
  const bool secondary_checks_;
  const bool compares_colours_;  ///< of textured surfaces
  const RateMap& rates_;
};

}  // namespace kernels
