#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools::reproduce {

/// Pixels by what parts the sixteen samples of a regular grid in them; a pixel is of the first kind that fits.
enum class Mask : std::uint8_t {
  kObjectEdge,      ///< objects differ, or a normal from the first one's (dot product below 0.9)
  kShadowEdge,      ///< a light reaches some of them
  kReflectionEdge,  ///< objects or shadows seen by a mirror or through glass differ
  kTextureEdge,     ///< the surface has a texture, and colours lie far apart (0.1 of any channel, sRGB-encoded)
  kElsewhere,
  kCount
};
constexpr std::array<std::string_view, static_cast<std::size_t>(Mask::kCount)> names_of(Mask) {
  return {"object_edges", "shadow_edges", "reflection_edges", "texture_edges", "elsewhere"};
}

/// The mask of each pixel of a view, row by row.
std::vector<Mask> masks_of(const Inputs& inputs, std::uint32_t threads);

/// Mean squared error of the pixels of each mask, as mean_squared_error() has it; nothing where it has no pixels.
using MaskedErrors = std::array<std::optional<double>, static_cast<std::size_t>(Mask::kCount)>;
MaskedErrors masked_errors(std::span<const Mask> masks, std::span<const float> a, std::span<const float> b);

}  // namespace tools::reproduce
