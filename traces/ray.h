#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include <glm/vec3.hpp>

namespace traces {

enum class RayKind : std::uint8_t { kPrimary, kShadow, kReflection, kRefraction, kCount };

/// A ray segment: points origin + t * direction with t_min <= t <= t_max. The direction need not be of unit length.
struct Ray {
  glm::vec3 origin{0};
  float t_min = 0;
  glm::vec3 direction{0};
  float t_max = std::numeric_limits<float>::infinity();
};

inline constexpr std::uint32_t kNoHit = 0xffffffffU;

// Two flags that a triangle hands to its hits, above the index: the traversal knows no textures, so whether there
// really is a surface, and how much light passes, is for a shader to say.
inline constexpr std::uint32_t kAlphaFlag = 1U << 31;  ///< the material has an alpha: any ray may have to go on
inline constexpr std::uint32_t kTintFlag = 1U << 30;   ///< the material lets light in: shadow rays are tinted
inline constexpr std::uint32_t kTriangleMask = kTintFlag - 1;

/// Where a ray met a triangle; `u`, `v` are the barycentric weights of its second and third vertex. `triangle` is the
/// index in the memory image's leaf order, with the triangle's flags above it.
///
/// Shadow rays: a hit without flags says that something solid is in the way, no matter which and where. A flagged one
/// is the nearest of all hits.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0;
  float v = 0;
  std::uint32_t triangle = kNoHit;
  bool is_hit() const { return triangle != kNoHit; }
  std::uint32_t index() const { return triangle & kTriangleMask; }
  bool is_flagged() const { return triangle > kTriangleMask && is_hit(); }
};

// In a scene of instances (a memory image of two levels) a hit names its instance as well, in the same four words: `u`
// and `v` are whole numbers of kWeightBits bits, as shares of kWeightOne, and below each of them lies a half of the
// instance's number. That is as fine as floats are near 1/4.
inline constexpr std::uint32_t kWeightBits = 22, kHalfBits = 32 - kWeightBits;
inline constexpr std::uint32_t kHalfMask = (1U << kHalfBits) - 1;
inline constexpr std::uint32_t kWeightOne = (1U << kWeightBits) - 1;
inline constexpr std::uint32_t kMaxInstances = 1U << (2 * kHalfBits);

inline Hit with_instance(const Hit& hit, std::uint32_t instance) {
  const auto whole = [](float weight) {
    return static_cast<std::uint32_t>(weight * static_cast<float>(kWeightOne) + 0.5F);
  };
  const std::uint32_t u = std::min(whole(hit.u), kWeightOne), v = std::min(whole(hit.v), kWeightOne - u);
  return {hit.t, std::bit_cast<float>(u << kHalfBits | (instance & kHalfMask)),
          std::bit_cast<float>(v << kHalfBits | instance >> kHalfBits), hit.triangle};
}
/// Instance of a hit made by with_instance().
inline std::uint32_t instance_of(const Hit& hit) {
  return (std::bit_cast<std::uint32_t>(hit.u) & kHalfMask) | (std::bit_cast<std::uint32_t>(hit.v) & kHalfMask)
                                                                 << kHalfBits;
}

}  // namespace traces
