#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "hw_models/machines/gpu_config.h"
#include "tools/studies/microbench/figure.h"
#include "traces/walk.h"

namespace tools {

/// A leaf of a walk: its first triangle, and where each test ends.
struct Leaf {
  std::uint32_t first = 0;
  std::vector<traces::ExitPhase> exits;
};

/// A ray that goes straight down, through `visits` nodes each of which hits one child, then into a leaf if it has
/// tests. Nothing is ever pushed, so that the stack's scheme does not matter.
struct StraightRay {
  std::uint32_t visits = 1;
  Leaf leaf;

  std::vector<std::uint32_t> walk() const {
    std::vector<std::uint32_t> steps;
    for (std::uint32_t i = 0; i < visits; ++i) {
      const bool last = i + 1 == visits;
      steps.push_back(traces::visit_step(i, last && leaf.exits.empty() ? 0 : 1, 0));
    }
    if (!leaf.exits.empty()) {
      std::uint32_t phases = 0;
      for (std::size_t i = 0; i < leaf.exits.size(); ++i) phases |= static_cast<std::uint32_t>(leaf.exits[i]) << 4 * i;
      steps.push_back(traces::leaf_step(leaf.first, static_cast<std::uint32_t>(leaf.exits.size())));
      steps.push_back(phases);
    }
    steps.push_back(traces::end_step(!leaf.exits.empty()));
    return steps;
  }
};

/// Cycles that a T&I unit must take by its configuration, if every line is in its L1s.
class TniForms {
 public:
  TniForms(const hw::GpuConfig& config, std::uint32_t triangle_bytes)
      : tni_(config.tni), direct_(config.direct_interface), triangle_bytes_(triangle_bytes) {}

  /// The stage of the intersection pipeline after which a test is known.
  std::uint32_t stage(traces::ExitPhase exit) const {
    switch (exit) {
      case traces::ExitPhase::kDistance:
        return tni_.ist.distance_stage;
      case traces::ExitPhase::kBarycentric:
        return tni_.ist.barycentric_stage;
      case traces::ExitPhase::kHit:
        break;
    }
    return tni_.ist.latency;
  }
  /// Lines of the leaf's first triangles: one is read a cycle, the same one again for a triangle that shares it.
  std::uint32_t lines(const Leaf& leaf, std::uint32_t triangles) const {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < triangles; ++i) {
      const std::uint64_t begin = std::uint64_t{leaf.first + i} * triangle_bytes_;
      count += begin / 64 == (begin + triangle_bytes_ - 1) / 64 ? 1 : 2;
    }
    return count;
  }
  std::uint32_t lines(const Leaf& leaf) const { return lines(leaf, static_cast<std::uint32_t>(leaf.exits.size())); }
  /// A lone leaf, from its arrival at the unit to its answer.
  std::uint32_t leaf_time(const Leaf& leaf) const {
    std::uint32_t known = 0;
    for (std::uint32_t i = 0; i < leaf.exits.size(); ++i)
      known = std::max(known, lines(leaf, i + 1) - 1 + tni_.ist.l1.hit_cycles + stage(leaf.exits[i]));
    return known;
  }
  /// A lone ray, from its arrival at a traversal unit to its leaving.
  std::uint32_t ray_time(const StraightRay& ray) const {
    const std::uint32_t pass = tni_.trv.l1.hit_cycles + tni_.trv.box_latency;
    const std::uint32_t to_ist_and_back = tni_.trv.leaf_latency + leaf_time(ray.leaf) + 1;
    return passes(ray) * pass + (ray.leaf.exits.empty() ? 0 : to_ist_and_back);
  }

  /// Leaves a cycle through the intersection unit if there are always more. Its turns go round, so that the leaves
  /// inside read in step, and end within a round of each other; if a round is shorter than the rest of the pipe, the
  /// unit has nothing to read until the first of them has left.
  UpperBound leaves_per_cycle(const Leaf& leaf) const {
    const std::uint32_t round = tni_.ist.leaves, rest = leaf_time(leaf) - lines(leaf) + 2;
    const std::uint32_t idle = rest > round ? rest - round : 0;
    return {double(round) / (round * lines(leaf) + idle), idle == 0 ? "intersection" : "leaves inside"};
  }
  /// Upper bound of rays a cycle through the whole unit, with what sets it.
  UpperBound rays_per_cycle(const StraightRay& ray) const {
    const auto tests = static_cast<std::uint32_t>(ray.leaf.exits.size());
    // One box tester: passes and leaves share a pipe. Two: the box pipe and the leaf pipe work side by side.
    const std::uint32_t busy = tni_.trv.box_testers == 1 ? passes(ray) + tests : std::max(passes(ray), tests);
    // A ray's slot is taken from its dispatch to its collection: a wire there and one back.
    const std::uint32_t taken = ray_time(ray) + 2;
    std::vector<UpperBound> bounds = {{double(tni_.trvs) / busy, "traversal"},
                                      {double(tni_.trvs) * tni_.trv.rays / taken, "rays inside", false},
                                      {1.0 / direct_.interval, "interface"},
                                      {direct_.depth / 2.0, "interface"},
                                      {1, "dispatcher"}};
    if (tests != 0) {
      bounds.push_back({1.0 / lines(ray.leaf), "intersection"});
      bounds.push_back({double(tni_.ist.leaves) / (leaf_time(ray.leaf) + 1), "leaves inside", false});
    }
    return least(bounds);
  }

 private:
  std::uint32_t passes(const StraightRay& ray) const { return ray.visits * (tni_.trv.box_testers == 1 ? 2 : 1); }

  const hw::TniConfig tni_;
  const hw::DirectInterfaceConfig direct_;
  const std::uint32_t triangle_bytes_;
};

}  // namespace tools
