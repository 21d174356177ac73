#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools::reproduce {

/// Classes of pixels by how their sixteen samples on a regular grid differ. The first class that applies counts.
enum class Mask : std::uint8_t {
  kObjectEdge,      ///< objects differ, or a normal differs from the first (dot product below 0.9)
  kShadowEdge,      ///< a light reaches only some samples
  kReflectionEdge,  ///< objects or shadows in a mirror or through glass differ
  kTextureEdge,     ///< the surface is textured, and colours differ by more than 0.1 in a channel (sRGB-encoded)
  kElsewhere,
  kCount
};
constexpr std::array<std::string_view, static_cast<std::size_t>(Mask::kCount)> names_of(Mask) {
  return {"object_edges", "shadow_edges", "reflection_edges", "texture_edges", "elsewhere"};
}

/// Returns the mask of each pixel of a view, row by row.
std::vector<Mask> masks_of(const Inputs& inputs, std::uint32_t threads);

/// Mean squared error of the pixels of each mask; nothing for a mask without pixels.
using MaskedErrors = std::array<std::optional<double>, static_cast<std::size_t>(Mask::kCount)>;
MaskedErrors masked_errors(std::span<const Mask> masks, std::span<const float> a, std::span<const float> b);

}  // namespace tools::reproduce
