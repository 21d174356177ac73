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
  bool are_shaded = true;    ///< else what is hit is found out, and not what it looks like
  bool have_shadows = true;  ///< shadow rays are cast, and those that were stopped marked
  std::uint32_t depth = std::numeric_limits<std::uint32_t>::max();  ///< longest path from the eye
  std::uint32_t mirrored = 0, refracted = 0;  ///< samples between a surface and what it shows that way; 0: not kept
  EyeUniforms<float> eye{};
  float depth_scale = 0;
  bool keeps_branch(std::uint32_t bounce) const { return are_kept && bounce == 2 && (mirrored | refracted) != 0; }
  std::uint32_t apart(traces::RayKind kind) const {
    return kind == traces::RayKind::kReflection ? mirrored : refracted;
  }
};

/// Effects of first hits that some samples alone have rays for (kernels/effects.h).
struct RatedEffects {
  bool are_rated = false;
  std::uint32_t layer = 0;     ///< samples between what one keeps of one light and of the next
  GridUniforms<float> grid{};  ///< pixels of the tile buffer
};

/// Records of their hits that samples keep, beside their colour.
struct RetainedRecords {
  bool geometry = false, surfaces = false;  ///< the first hit's: geometry alone, or all that shading needs
  bool secondary = false;
  bool traits = false;  ///< those of the first hit and of the secondary one that carries most
  VisibleSamples visible{};
  RatedEffects rated{};
  StreamBuilder::Node cleared = StreamBuilder::kNone,
                      cleared_secondary = StreamBuilder::kNone;  ///< launches that began them
};

}  // namespace kernels
