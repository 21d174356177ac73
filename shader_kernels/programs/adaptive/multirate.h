#pragma once
#include <cstdint>

#include "shader_kernels/programs/adaptive/block_program.h"
#include "shader_kernels/programs/adaptive/multirate_config.h"
#include "shader_kernels/programs/adaptive/rate_map.h"

namespace kernels {

/// Frame programs multirate:under and multirate:super (Lee et al. 2016): samples between similar ones take the colour
/// in their middle. A sample is a pixel, or one of four of a pixel.
///
///   per tile: references -> check_similarity_x -> interpolate | trace -> check_similarity_y -> interpolate | trace
///             -> average_samples -> pack_colour -> transfer to the frame buffer
class MultirateProgram final : public BlockProgram {
 public:
  /// `grid`: samples along a pixel, 1 or 2. `rates` must stay as they are while the program is in use.
  MultirateProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                   const MultirateConfig& multirate, std::uint32_t grid, const RateMap& rates, std::uint32_t frame);

 private:
  std::uint32_t block_of(std::uint32_t tile) const override { return rates_.block(tile); }
  bool carries_rates() const override { return multirate_.rate_control != RateControl::kOff; }
  Wavefront::RetainedRecords records_to_retain(bool is_last) const override;
  Verdict check(Tile& tile, bool along_y, const LineUniforms<float>& line, std::uint32_t items) const override;
  void interpolate(Tile& tile, bool along_y, const LineUniforms<float>& line, const Verdict& verdict) const override;

  template <bool kTexture>
  Verdict check_colours(Tile& tile, bool along_y, const LineUniforms<float>& line, std::uint32_t items) const;
  template <bool kAlongY, bool kSecondary, bool kTexture>
  Verdict check_with(Tile& tile, const LineUniforms<float>& line, std::uint32_t items) const;
  template <class K>
  void interpolate_with(Tile& tile, const LineUniforms<float>& line, const Verdict& verdict) const;

  const MultirateConfig multirate_;
  const bool secondary_checks_;  ///< made
  const bool compares_colours_;  ///< those of textured surfaces
  const RateMap& rates_;
};

}  // namespace kernels
