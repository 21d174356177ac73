#pragma once
#include <cstdint>
#include <limits>

#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/programs/wavefront/stream_builder.h"
#include "traces/ray.h"

namespace kernels {

/// Geometry that samples of reconstruct keep, and of which rays.
struct VisibleSamples {
  bool are_kept = false;
  bool are_shaded = true;                                           ///< false: hits are found but not shaded
  bool have_shadows = true;                                         ///< shadow rays are cast, and blocked ones recorded
  std::uint32_t depth = std::numeric_limits<std::uint32_t>::max();  ///< longest path from the eye
  std::uint32_t mirrored = 0, refracted = 0;  ///< offset from a surface's sample to those of mirrored and refracted
                                              ///< rays; 0: not kept
  EyeUniforms<float> eye{};
  float depth_scale = 0;
  bool keeps_branch(std::uint32_t bounce) const { return are_kept && bounce == 2 && (mirrored | refracted) != 0; }
  std::uint32_t apart(traces::RayKind kind) const {
    return kind == traces::RayKind::kReflection ? mirrored : refracted;
  }
};

/// Effects of first hits that only some samples trace rays for (kernels/effects.h).
struct RatedEffects {
  bool are_rated = false;
  std::uint32_t layer = 0;     ///< offset between a sample's data of one light and the next
  GridUniforms<float> grid{};  ///< pixels of the tile buffer
};

/// Records that samples keep of their hits, next to their colour.
struct RetainedRecords {
  bool geometry = false, surfaces = false;  ///< of the first hit: geometry, or all that shading needs
  bool secondary = false;
  bool traits = false;  ///< of the first hit and of the heaviest secondary one
  VisibleSamples visible{};
  RatedEffects rated{};
  StreamBuilder::Node cleared = StreamBuilder::kNone,
                      cleared_secondary = StreamBuilder::kNone;  ///< launches that cleared them
};

}  // namespace kernels
