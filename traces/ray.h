#pragma once
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

/// Where a ray met a triangle; `u`, `v` are the barycentric weights of its second and third vertex. `triangle` is the
/// index in the memory image's leaf order. For an any-hit (shadow) ray only "hit or not" has a meaning.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0;
  float v = 0;
  std::uint32_t triangle = kNoHit;
  bool is_hit() const { return triangle != kNoHit; }
};

}  // namespace traces
