#pragma once
#include <cstdint>
#include <cstring>
#include <vector>

#include "sim/hash.h"
#include "traces/accel/memory_image.h"
#include "traces/ray.h"

namespace traces {

/// Random number generator that gives the same numbers on every host.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  float unit() { return sim::hash_to_unit_float(sim::hash(seed_, counter_++)); }
  float between(float low, float high) { return low + (high - low) * unit(); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(sim::hash(seed_, counter_++) % n); }
  glm::vec3 point(float low = -1, float high = 1);
  glm::vec3 direction();

 private:
  std::uint64_t seed_;
  std::uint64_t counter_ = 0;
};

Scene scene_of(Mesh mesh);
/// Returns `count` random triangles of about `size` in the cube from -1 to 1.
Scene triangle_soup(std::uint32_t count, float size, std::uint64_t seed = 1);
/// Returns random triangles with corners on a grid of spacing 1/8. Many share planes, edges and distances, have flat
/// boxes or no area.
Scene grid_soup(std::uint32_t count, std::uint64_t seed = 1);
/// Returns a closed sphere of radius 1 around the origin.
Scene sphere(std::uint32_t rings, std::uint32_t segments);
/// Returns a scene of one triangle: (0,0,0), (1,0,0), (0,1,0).
Scene one_triangle();

/// Returns a scene of `count` instances that are rotated, scaled or mirrored. Some are flat or have no triangles.
Scene scattered(std::uint32_t count, std::uint64_t seed = 4);

/// Returns the scene with two of three triangles not opaque: one material with alpha, and one that transmits light.
Scene with_transparent_triangles(Scene scene);

/// Returns the scene with all materials single-sided.
Scene single_sided(Scene scene);

std::vector<Ray> random_rays(std::uint32_t count, std::uint64_t seed = 2);
/// Returns rays that start on a grid of spacing 1/8 and follow it. Directions have zero components of both signs;
/// origins are on planes, edges and corners.
std::vector<Ray> grid_rays(std::uint32_t count, std::uint64_t seed = 3);

std::vector<Hit> trace(const Tracer& tracer, const std::vector<Ray>& rays, RayKind kind = RayKind::kPrimary);
/// Returns the hit found by brute force: tests every triangle of every instance, with BvhTracer's triangle test and
/// rule for equal distances.
Hit test_all(const MemoryImage& image, const Ray& ray);

template <class Record>
bool same_bytes(const std::vector<Record>& a, const std::vector<Record>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Record)) == 0);
}

/// Returns the number of hits that differ in any bit.
std::uint64_t count_different(const std::vector<Hit>& a, const std::vector<Hit>& b);
/// Returns the number of results that differ between portable and native arithmetic, for nearest-hit and shadow rays.
/// Compared are hits, traversal words and where traversals begin.
std::uint64_t count_different_in_portable(const MemoryImage& image, const std::vector<Ray>& rays);

}  // namespace traces
