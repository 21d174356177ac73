#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "traces/accel/bvh_tracer.h"
#include "traces/accel/memory_image.h"
#include "traces/ray.h"
#include "traces/walk.h"

namespace traces {

/// A hit without the numbers that depend on the order of leaves.
struct NamedHit {
  float t, u, v;
  std::uint32_t source, flags;
  friend bool operator==(const NamedHit& a, const NamedHit& b) { return std::memcmp(&a, &b, sizeof a) == 0; }
};

inline NamedHit name_hit(const MemoryImage& image, const Hit& hit) {
  if (!hit.is_hit()) return {hit.t, 0, 0, kNoHit, 0};
  return {hit.t, hit.u, hit.v, image.triangles[hit.triangle_index()].source, hit.triangle & ~kTriangleMask};
}

/// Counts of the canonical walks of some rays, over trees of any width.
struct WalkCounts {
  std::uint64_t rays = 0, visits = 0, roots = 0, leaves = 0, boxes = 0, triangles = 0, hit_children = 0;
  std::uint64_t pushes = 0, pops = 0, culled = 0;
  std::uint64_t dropped = 0;  ///< entries left on the stack when rays ended
  std::uint64_t sum_of_deepest = 0, deepest = 0;
};

inline void count_walk(const MemoryImage& image, const std::uint32_t* at, WalkCounts& out) {
  std::uint64_t depth = 0, deepest = 0;
  bool pops = false, is_root = true;
  for (;; ++at) {
    const std::uint32_t word = *at;
    if (kind_of(word) == StepKind::kCull) {
      depth -= culled_of(word);
      out.culled += culled_of(word);
      continue;
    }
    if (kind_of(word) == StepKind::kEnd) break;
    if (pops) {
      --depth;
      ++out.pops;
    }
    pops = false;
    if (kind_of(word) == StepKind::kVisit) {
      ++out.visits;
      out.roots += is_root ? 1 : 0;
      is_root = false;
      for (const std::uint32_t link : image.links_of(node_of(word))) out.boxes += link != kNoChild ? 1 : 0;
      const auto hits = static_cast<std::uint32_t>(is_wide(word) ? hit_count_of(*++at) : std::popcount(hits_of(word)));
      out.hit_children += hits;
      if (hits > 1) out.pushes += hits - 1;
      if (hits > 1) depth += hits - 1;
      pops = hits == 0;
    } else if (is_enter(word)) {
      ++out.leaves;
      is_root = true;
    } else {
      ++out.leaves;
      out.triangles += count_of(word);
      ++at;
      pops = true;
    }
    deepest = std::max(deepest, depth);
  }
  ++out.rays;
  out.dropped += depth;
  out.sum_of_deepest += deepest;
  out.deepest = std::max(out.deepest, deepest);
}

/// Traces rays and counts their walks.
inline WalkCounts count_walks(const MemoryImage& image, const std::vector<Ray>& rays, RayKind kind,
                              std::vector<Hit>& hits) {
  hits.resize(rays.size());
  std::vector<std::uint32_t> words, begin;
  WalkSink sink{words, begin};
  BvhTracer(image).trace(rays, kind, hits, &sink);
  WalkCounts counts;
  for (const std::uint32_t first : begin) count_walk(image, &words[first], counts);
  return counts;
}

}  // namespace traces
