#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/hash.h"
#include "tests/hw_models/tni/bench.h"
#include "traces/walk.h"

namespace hw::testing {

using Walk = std::vector<std::uint32_t>;

/// A random tree of `nodes` inner nodes and rays that walk it with consistent stacks.
struct RandomLoad {
  std::vector<std::uint32_t> parents;
  std::vector<traces::NodeRecord> links;
  std::vector<Walk> walks;

  explicit RandomLoad(std::uint64_t seed, std::uint32_t nodes = 400, std::uint32_t rays = 300) {
    parents.resize(nodes);
    for (std::uint32_t i = 1; i < nodes; ++i) parents[i] = (i - 1) / 2;
    links.resize(nodes);
    for (std::uint32_t i = 0; i < nodes; ++i) {
      for (std::uint32_t c = 0; c < 2; ++c) {
        const std::uint32_t child = 2 * i + 1 + c;
        links[i].child[c] = is_leaf(child, nodes) ? traces::leaf_link(child * 4, 4) : child;
      }
    }
    for (std::uint32_t r = 0; r < rays; ++r) walks.push_back(walk(seed, r, nodes));
  }
  static bool is_leaf(std::uint32_t node, std::uint32_t nodes) { return 2 * node + 2 >= nodes; }
  static Walk walk(std::uint64_t seed, std::uint32_t ray, std::uint32_t nodes) {
    Walk out;
    std::vector<std::uint32_t> stack;
    std::uint32_t node = 0;
    for (std::uint32_t step = 0;; ++step) {
      const std::uint64_t h = sim::hash(seed, ray, step);
      bool pop = false;
      if (is_leaf(node, nodes)) {
        const auto count = static_cast<std::uint32_t>(1 + h % 4);
        out.push_back(traces::leaf_step(node * 4, count));
        std::uint32_t phases = 0;
        for (std::uint32_t t = 0; t < count; ++t) {
          phases |= static_cast<std::uint32_t>(1 + (h >> (8 + 2 * t)) % 3) << (4 * t);
        }
        out.push_back(phases);
        pop = true;
      } else {
        const auto hits = static_cast<std::uint32_t>((h >> 4) % 4);
        out.push_back(traces::visit_step(node, hits, 0));
        if (hits == 3) stack.push_back(2 * node + 2);
        pop = hits == 0;
        node = hits == 2 ? 2 * node + 2 : 2 * node + 1;
      }
      if (!pop) continue;
      const auto culled = static_cast<std::uint32_t>(std::min<std::size_t>(stack.size(), (h >> 40) % 3 == 0 ? 1 : 0));
      if (culled > 0) {
        out.push_back(traces::cull_step(culled));
        stack.resize(stack.size() - culled);
      }
      if (stack.empty()) break;
      node = stack.back();
      stack.pop_back();
    }
    out.push_back(traces::end_step(false));
    return out;
  }
  /// The tree and the rays, for a bench.
  void give(TniBench::Setup& setup) const {
    setup.parents = parents;
    setup.links = links;
  }
  TniBench& send(TniBench& bench) const {
    for (const Walk& w : walks) bench.add(w);
    return bench;
  }
};

/// Any T&I unit and any memory.
inline TniBench::Setup random_setup(std::uint64_t seed) {
  const auto draw = [&](std::uint32_t dimension, std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(sim::hash(seed, dimension) % (high - low + 1));
  };
  TniBench::Setup s;
  s.config.trvs = draw(0, 1, 4);
  s.config.link_depth = draw(1, 1, 3);
  s.config.trv.rays = draw(2, 1, 64);
  s.config.trv.box_latency = draw(3, 1, 20);
  s.config.trv.stack_latency = draw(4, 1, 4);
  s.config.trv.leaf_latency = draw(5, 1, 8);
  s.config.trv.stack_entries = draw(6, 1, 8);
  s.config.trv.l1.mshrs = draw(7, 1, 8);
  s.config.trv.l1.size.bytes = std::uint64_t{256} << draw(8, 0, 5);
  s.config.ist.leaves = draw(9, 1, 32);
  s.config.ist.l1.mshrs = draw(10, 1, 8);
  s.config.ist.l1.size.bytes = std::uint64_t{256} << draw(11, 0, 5);
  s.fifo = draw(12, 1, 64);
  s.hit_interval = draw(13, 1, 3);
  s.drain_every = draw(14, 1, 40);
  s.memory_latency = draw(15, 1, 80);
  s.config.miss_handling = static_cast<MissHandling>(draw(16, 0, 3));
  s.config.rau = {draw(17, 1, 8), draw(18, 1, 6)};
  s.config.dispatch = static_cast<Dispatch>(draw(19, 0, 1));
  s.config.trv.box_testers = draw(20, 1, 2);
  s.config.trv.prefetch = static_cast<Prefetch>(draw(21, 0, 1));
  s.config.trv.stack = static_cast<StackScheme>(draw(22, 0, 2));
  if (s.config.trv.stack == StackScheme::kRestartTrail) s.config.trv.stack_entries -= 1;
  s.node_bytes = std::array{64U, 32U, 40U, 48U}[draw(23, 0, 3)];
  s.triangle_bytes = draw(24, 0, 1) == 0 ? 48 : 36;
  s.hybrid = draw(25, 0, 1) == 1;
  s.perfect = {draw(26, 0, 5) == 0, draw(27, 0, 5) == 0};
  return s;
}

}  // namespace hw::testing
