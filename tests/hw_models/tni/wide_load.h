#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "sim/hash.h"
#include "tests/hw_models/tni/harness.h"
#include "tests/hw_models/tni/random_load.h"
#include "traces/walk.h"

namespace hw::test {

/// Returns the words of a visit to a wide node. `order`: slots of the hit children in visiting order.
inline std::array<std::uint32_t, 2> wide_visit(std::uint32_t node, const std::vector<std::uint32_t>& order) {
  std::uint32_t mask = 0, slots = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    mask |= 1U << order[i];
    slots |= order[i] << traces::kSlotBits * i;
  }
  return {traces::wide_step(node), traces::wide_hits(mask, slots)};
}

/// Random rays that traverse random trees of wide nodes with consistent stacks. With `levels` there are two levels: a
/// tree over instances of three trees.
struct WideLoad {
  /// Counts over all walks, as a unit without restarts counts them.
  struct Counts {
    std::uint64_t visits = 0, children = 0, hits = 0, leaves = 0, culled = 0, dropped = 0, enters = 0;
  };

  std::uint32_t width;  ///< most children of a node
  std::vector<traces::WideNode> nodes;
  std::vector<std::uint32_t> parents;
  std::vector<traces::InstanceRecord> placed;
  std::vector<Walk> walks;
  Counts counts;

  WideLoad(std::uint64_t seed, std::uint32_t most_children, std::uint32_t size = 120, std::uint32_t rays = 200,
           bool levels = false)
      : width(most_children), seed_(seed) {
    if (levels) {
      std::vector<std::uint32_t> parents_of_instances;
      add_tree(24, &parents_of_instances);
      for (std::uint32_t k = 0; k < kTrees; ++k) {
        const auto root = static_cast<std::uint32_t>(nodes.size());
        for (std::size_t i = k; i < placed.size(); i += kTrees) placed[i].root = root;
        add_tree(size / 3, nullptr);
      }
      parents.insert(parents.end(), parents_of_instances.begin(), parents_of_instances.end());
    } else {
      add_tree(size, nullptr);
    }
    for (std::uint32_t r = 0; r < rays; ++r) walks.push_back(walk());
  }

  /// Copies the trees into the setup of a harness. `lines`: most lines of a node; each has up to that many.
  void give(TniHarness::Setup& setup, std::uint32_t lines = 1) const {
    setup.kind.wide = true;
    setup.kind.slots = width;
    setup.parents = parents;
    setup.wide_links = nodes;
    setup.placed = placed;
    std::uint32_t line = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::uint32_t taken = lines - static_cast<std::uint32_t>(i % 2 == 0 ? 0 : lines - 1);
      setup.wide.push_back({line, static_cast<std::uint8_t>(taken), static_cast<std::uint8_t>(children_of(i))});
      line += lines;
    }
  }
  TniHarness& send(TniHarness& harness) const {
    for (const Walk& w : walks) harness.add(w);
    return harness;
  }
  std::uint32_t children_of(std::size_t node) const {
    return static_cast<std::uint32_t>(
        std::ranges::count_if(nodes[node].child, [](std::uint32_t link) { return link != traces::kNoChild; }));
  }

 private:
  static constexpr std::uint32_t kTrees = 3;

  std::uint64_t below(std::uint64_t n) { return sim::hash(seed_, draws_++) % n; }

  /// Adds a tree of `size` inner nodes, whose leaves are instances if `parents_of_instances` is not null.
  void add_tree(std::uint32_t size, std::vector<std::uint32_t>* parents_of_instances) {
    const auto root = static_cast<std::uint32_t>(nodes.size());
    std::uint32_t next = root + 1;
    parents.push_back(root);
    for (std::uint32_t node = root; node < next; ++node) {
      traces::WideNode& record = nodes.emplace_back();
      std::ranges::fill(record.child, traces::kNoChild);
      const auto children = static_cast<std::uint32_t>(2 + below(width - 1));
      for (std::uint32_t slot = 0; slot < children; ++slot) {
        if (next < root + size && (slot == 0 || below(2) == 0)) {
          parents.push_back(node);
          record.child[slot] = next++;
        } else if (parents_of_instances != nullptr) {
          record.child[slot] = traces::instance_link(static_cast<std::uint32_t>(placed.size()));
          placed.emplace_back();
          parents_of_instances->push_back(node);
        } else {
          record.child[slot] = traces::leaf_link(4 * (node * width + slot), static_cast<std::uint32_t>(1 + below(4)));
        }
      }
    }
  }

  Walk walk() {
    Walk out;
    std::vector<std::uint32_t> stack;
    for (std::uint32_t at = 0;;) {
      bool pop = false;
      if (!traces::is_leaf(at)) {
        std::vector<std::uint32_t> order(children_of(at));
        std::iota(order.begin(), order.end(), 0U);
        for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[below(i)]);
        order.resize(below(order.size() + 1));
        const auto words = wide_visit(at, order);
        out.insert(out.end(), words.begin(), words.end());
        counts.visits += 1;
        counts.children += children_of(at);
        counts.hits += order.size();
        pop = order.empty();
        const std::uint32_t node = at;
        for (std::size_t i = order.size(); i-- > 1;) stack.push_back(nodes[node].child[order[i]]);
        if (!pop) at = nodes[node].child[order[0]];
      } else if (traces::is_instance(at)) {
        out.push_back(traces::instance_step(traces::link_instance(at)));
        counts.enters += 1;
        at = placed[traces::link_instance(at)].root;
      } else {
        const std::uint32_t count = traces::leaf_count(at);
        out.push_back(traces::leaf_step(traces::leaf_first(at), count));
        std::uint32_t phases = 0;
        for (std::uint32_t t = 0; t < count; ++t) phases |= static_cast<std::uint32_t>(1 + below(3)) << (4 * t);
        out.push_back(phases);
        counts.leaves += 1;
        if (below(40) == 0) {  // a shadow ray that hits ends with entries on its stack
          counts.dropped += stack.size();
          break;
        }
        pop = true;
      }
      if (!pop) continue;
      if (const std::uint64_t culled = std::min<std::uint64_t>(stack.size(), below(3) == 0 ? 1 + below(3) : 0)) {
        out.push_back(traces::cull_step(static_cast<std::uint32_t>(culled)));
        stack.resize(stack.size() - culled);
        counts.culled += culled;
      }
      if (stack.empty()) break;
      at = stack.back();
      stack.pop_back();
    }
    out.push_back(traces::end_step(false));
    out.resize(out.size() + 16, traces::end_step(false));  // a slot prefetches later steps
    return out;
  }

  std::uint64_t seed_, draws_ = 0;
};

/// Returns a random configuration of T&I unit and memory for wide trees, determined by `seed`, without trees.
inline TniHarness::Setup random_wide_setup(std::uint64_t seed) {
  const auto draw = [&](std::uint32_t dimension, std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(sim::hash(seed, 100 + dimension) % (high - low + 1));
  };
  TniHarness::Setup s = random_setup(seed);
  TniConfig& config = s.config;
  config.trv.box_testers = draw(0, 1, 8);
  config.trv.idle_testers = static_cast<IdleTesters>(draw(1, 0, 1));
  config.trv.decode_latency = draw(2, 0, 4);
  config.trv.order_latency = draw(3, 0, 4);
  config.trv.stack = static_cast<StackScheme>(draw(4, 0, 3));
  config.trv.stack_push = static_cast<StackPush>(draw(5, 0, 1));
  if (config.trv.box_testers == 1) config.trv.gather = Gather::kOff;
  const bool may_be_empty = config.trv.stack >= StackScheme::kRestartTrail;
  config.trv.stack_entries = draw(6, may_be_empty ? 0 : 1, 8);
  config.ists = draw(7, 1, std::min(config.trvs, 4U));
  config.ist.decode_interval = draw(8, 1, 4);
  s.kind.format = static_cast<traces::NodeFormat>(draw(9, 0, 4));
  s.kind.order = static_cast<traces::ChildOrder>(draw(10, 0, 2));
  s.parents_in_nodes = draw(11, 0, 1) == 1;
  if (draw(12, 0, 1) == 1) {  // leaf records of up to four triangles
    s.triangle_bytes = draw(13, 0, 1) == 0 ? 64 : 128;
    s.decoded = s.triangle_bytes == 128;
    for (std::uint32_t i = 0; i < 8192; ++i) {
      s.triangle_places.push_back(i / (1 + draw(14, 0, 3)) * (s.triangle_bytes / 16));
    }
  }
  return s;
}

}  // namespace hw::test
