#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

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

// Flags of a triangle, in the two top bits of Hit::triangle. Traversal reads no textures, so a shader that sees a flag
// determines whether the surface exists at the hit and how much light passes.
inline constexpr std::uint32_t kAlphaFlag = 1U << 31;  ///< the material has alpha: any ray may pass through
inline constexpr std::uint32_t kTintFlag = 1U << 30;   ///< the material is transparent: shadow rays are tinted
inline constexpr std::uint32_t kTriangleMask = kTintFlag - 1;

/// The intersection of a ray and a triangle. `u` and `v` are the barycentric weights of the second and third vertex. In
/// `triangle`, the two top bits are the triangle's flags (kAlphaFlag, kTintFlag) and the others its index in the memory
/// image's leaf order.
///
/// For a shadow ray, a hit without flags is any opaque triangle that blocks the ray. A hit with flags is the nearest
/// hit, which means that no opaque triangle blocks the ray.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0;
  float v = 0;
  std::uint32_t triangle = kNoHit;
  bool is_hit() const { return triangle != kNoHit; }
  std::uint32_t triangle_index() const { return triangle & kTriangleMask; }
  bool is_flagged() const { return triangle > kTriangleMask && is_hit(); }
};

// In a two-level memory image a hit also names its instance, within the same four words. The upper kWeightBits bits of
// `u` and `v` are fixed-point weights (kWeightOne is 1), and the lower bits of each contain half of the instance's
// number. The resolution of a weight equals that of a float near 1/4.
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
/// Returns the instance of a hit made by with_instance().
inline std::uint32_t instance_index_of(const Hit& hit) {
  return (std::bit_cast<std::uint32_t>(hit.u) & kHalfMask) | (std::bit_cast<std::uint32_t>(hit.v) & kHalfMask)
                                                                 << kHalfBits;
}

class RayPredictor;
class TilePredictions;

/// Buffers to which a tracer appends the recorded traversals of rays (canonical walks, walk.h). It appends to `begin`
/// the index of each ray's first word.
struct WalkSink {
  std::vector<std::uint32_t>& words;
  std::vector<std::uint32_t>& begin;
  TilePredictions* predictions = nullptr;  ///< if not null, shadow rays are predicted (accel/ray_predictor.h)
};

/// Interface of a tracer, which finds the hits of rays. A shadow ray ends at the first opaque triangle (without flags);
/// if there is none, its hit is the nearest flagged triangle. Any other ray finds its nearest hit.
class Tracer {
 public:
  virtual ~Tracer() = default;
  /// Traces `rays` and writes one entry of `hits` per ray. `walk` may be null; only BvhTracer records walks.
  virtual void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const = 0;
  /// Returns the predictor of the tracer's shadow rays; null if it has none.
  virtual const RayPredictor* ray_predictor() const { return nullptr; }
};

}  // namespace traces
