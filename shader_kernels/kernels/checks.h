#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace kernels {

/// Similarity checks between the two samples that a third lies between; a bit each in what a check kernel leaves in the
/// tile buffer, where 0 means that all have passed. Their order is that of the papers; the first to fail is what a
/// sample is said to be traced for.
enum class Check : std::uint8_t {
  kObject,
  kPosition,
  kNormal,
  kConvexity,
  kTexture,
  kShadow,
  kColour,
  kSecondaryObject,
  kSecondaryNormal,
  kSecondaryShadow,
  kDetail,  ///< a surface that cannot be shaded from interpolated attributes
  kBorder,  ///< one of the two lies outside the picture
  kCount
};
constexpr std::array<std::string_view, 12> names_of(Check) {
  return {"object", "position",         "normal",           "convexity",        "texture", "shadow",
          "colour", "secondary_object", "secondary_normal", "secondary_shadow", "detail",  "border"};
}
constexpr std::uint32_t bit(Check check) { return 1U << static_cast<std::uint32_t>(check); }

}  // namespace kernels
