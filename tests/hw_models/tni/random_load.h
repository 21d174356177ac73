#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/hash.h"
#include "tests/hw_models/tni/harness.h"
#include "traces/walk.h"

namespace hw::test {

using Walk = std::vector<std::uint32_t>;

/// Random rays that traverse a tree of `nodes` inner nodes with consistent stacks. With `levels` there are two levels:
/// a tree over instances of three such trees.
struct RandomLoad {
  std::vector<std::uint32_t> parents;
  std::vector<traces::NodeRecord> links;
  std::vector<traces::InstanceRecord> placed;
  std::vector<Walk> walks;

  explicit RandomLoad(std::uint64_t seed, std::uint32_t nodes = 400, std::uint32_t rays = 300, bool levels = false) {
    if (levels) {
      add_tree(kTop, true);
      for (std::uint32_t k = 0; k < kTrees; ++k) {
        const auto root = static_cast<std::uint32_t>(links.size());
        for (std::uint32_t i = k; i < kInstances; i += kTrees) placed[i].root = root;
        add_tree(nodes / 4, false);
      }
      for (std::uint32_t i = 0; i < kInstances; ++i) parents.push_back((kTop - kInstances + i - 1) / 2);
    } else {
      add_tree(nodes, false);
    }
    for (std::uint32_t r = 0; r < rays; ++r) walks.push_back(walk(seed, r, levels ? kTop : nodes, nodes / 4));
  }
  static bool is_leaf(std::uint32_t node, std::uint32_t nodes) { return 2 * node + 2 >= nodes; }
  /// Copies the trees into the setup of a harness.
  void give(TniHarness::Setup& setup) const {
    setup.parents = parents;
    setup.links = links;
    setup.placed = placed;
  }
  TniHarness& send(TniHarness& harness) const {
    for (const Walk& w : walks) harness.add(w, 1, static_cast<std::uint32_t>(sim::hash(w.size()) % 512));
    return harness;
  }

 private:
  static constexpr std::uint32_t kTop = 31, kInstances = 16, kTrees = 3;
  static constexpr std::uint32_t kNowhere = 0xffffffffU;

  /// A position in a traversal: a node, numbered within its tree, and the instance of that tree.
  struct NodeInTree {
    std::uint32_t node = 0;
    std::uint32_t instance = kNowhere;
  };

  void add_tree(std::uint32_t nodes, bool over_instances) {
    const auto root = static_cast<std::uint32_t>(links.size());
    if (over_instances) placed.resize(kInstances);
    for (std::uint32_t i = 0; i < nodes; ++i) {
      parents.push_back(i == 0 ? root : root + (i - 1) / 2);
      traces::NodeRecord& node = links.emplace_back();
      for (std::uint32_t c = 0; c < 2; ++c) {
        const std::uint32_t child = 2 * i + 1 + c;
        if (!is_leaf(child, nodes)) {
          node.child[c] = root + child;
        } else if (over_instances) {
          node.child[c] = traces::instance_link((child + kInstances - kTop) % kInstances);
        } else {
          node.child[c] = traces::leaf_link(child * 4, 4);
        }
      }
    }
  }

  Walk walk(std::uint64_t seed, std::uint32_t ray, std::uint32_t nodes, std::uint32_t object_nodes) const {
    Walk out;
    std::vector<NodeInTree> stack;
    NodeInTree at;
    for (std::uint32_t step = 0;; ++step) {
      const std::uint64_t h = sim::hash(seed, ray, step);
      bool pop = false;
      const bool inside = at.instance != kNowhere;
      const std::uint32_t root = inside ? placed[at.instance].root : 0;
      if (!is_leaf(at.node, inside ? object_nodes : nodes)) {
        const auto hits = static_cast<std::uint32_t>((h >> 4) % 4);
        out.push_back(traces::visit_step(root + at.node, hits, 0));
        if (hits == 3) stack.push_back({2 * at.node + 2, at.instance});
        pop = hits == 0;
        at.node = hits == 2 ? 2 * at.node + 2 : 2 * at.node + 1;
      } else if (!inside && !placed.empty()) {
        at = {0, at.node + kInstances - kTop};
        out.push_back(traces::instance_step(at.instance));
      } else {
        const auto count = static_cast<std::uint32_t>(1 + h % 4);
        out.push_back(traces::leaf_step(at.node * 4, count));
        std::uint32_t phases = 0;
        for (std::uint32_t t = 0; t < count; ++t) {
          phases |= static_cast<std::uint32_t>(1 + (h >> (8 + 2 * t)) % 3) << (4 * t);
        }
        out.push_back(phases);
        pop = true;
      }
      if (!pop) continue;
      const auto culled = static_cast<std::uint32_t>(std::min<std::size_t>(stack.size(), (h >> 40) % 3 == 0 ? 1 : 0));
      if (culled > 0) {
        out.push_back(traces::cull_step(culled));
        stack.resize(stack.size() - culled);
      }
      if (stack.empty()) break;
      at = stack.back();
      stack.pop_back();
    }
    out.push_back(traces::end_step(false));
    return out;
  }
};

/// Returns a random configuration of T&I unit and memory, determined by `seed`.
inline TniHarness::Setup random_setup(std::uint64_t seed) {
  const auto draw = [&](std::uint32_t dimension, std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(sim::hash(seed, dimension) % (high - low + 1));
  };
  TniHarness::Setup s;
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
  s.config.trv.prefetch = static_cast<Prefetch>(draw(21, 0, 3));
  s.config.trv.prefetch_depth = draw(28, 1, 4);
  s.config.trv.treelet_bytes.bytes = std::uint64_t{512} << draw(29, 0, 4);
  s.config.trv.stack = static_cast<StackScheme>(draw(22, 0, 2));
  if (s.config.trv.stack == StackScheme::kRestartTrail) s.config.trv.stack_entries -= 1;
  s.node_bytes = std::array{64U, 32U, 40U, 48U}[draw(23, 0, 3)];
  s.triangle_bytes = draw(24, 0, 1) == 0 ? 48 : 36;
  s.hybrid = draw(25, 0, 1) == 1;
  if (s.config.miss_handling == MissHandling::kReorder && s.config.trv.box_testers == 2)
    s.config.trv.gather = static_cast<Gather>(draw(30, 0, 1));
  s.config.trv.gather_width = draw(31, 4, 16);
  s.config.dispatcher = {static_cast<RaySort>(draw(32, 0, 1)), draw(33, 16, 64), draw(34, 1, 300)};
  s.ideal = {draw(26, 0, 5) == 0, draw(27, 0, 5) == 0};
  return s;
}

}  // namespace hw::test
