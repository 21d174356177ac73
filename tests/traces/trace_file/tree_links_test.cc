#include "traces/trace_file/tree_links.h"

#include <set>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/accel/support.h"
#include "tests/traces/trace_file/tiny_tile.h"
#include "traces/accel/build.h"

// Tests that the tree of a trace is stored without loss, and that no bytes decode to an invalid tree.

namespace traces {
namespace {

using test::tiny_levels;

TEST(TreeLinks, AreRestoredAndMustBeATree) {
  const MemoryImage image = build_memory_image(triangle_soup(3000, 0.2F), {}, 1);
  const Links links = links_of(image);
  const auto within = [](std::uint64_t triangles) { return ImageCounts{.triangles = triangles, .textures = {}}; };
  const std::uint64_t triangles = image.triangles.size();
  const std::string bytes = encode_child_links(links);
  EXPECT_EQ(decode_child_links(bytes, links.nodes.size(), within(triangles)), links);
  EXPECT_LT(bytes.size(), 4 * links.nodes.size());
  const Links one = links_of(build_memory_image(one_triangle(), {}, 1));
  EXPECT_EQ(decode_child_links(encode_child_links(one), 1, within(1)), one) << "a root with one child";

  EXPECT_THROW(decode_child_links(bytes, links.nodes.size(), within(triangles - 1)), sim::InputError);
  EXPECT_THROW(decode_child_links(bytes, links.nodes.size() - 1, within(triangles)), sim::InputError);
  EXPECT_THROW(decode_child_links(bytes, links.nodes.size() + 1, within(triangles)), sim::InputError);
  const std::uint32_t leaf = leaf_link(0, 1);
  const auto refused = [&](const decltype(Links::nodes)& bad) {
    EXPECT_THROW(decode_child_links(encode_child_links({bad, {}}), bad.size(), within(1)), sim::InputError);
  };
  refused({{1, 1}, {leaf, leaf}});                   // two parents
  refused({{1, leaf}, {leaf, leaf}, {leaf, leaf}});  // no parent
  refused({{leaf, leaf}, {leaf, leaf_link(1, 1)}});  // no such triangle
  refused({{1, leaf}, {leaf, kNoChild}});            // a child is missing
  decltype(Links::nodes) deep;
  for (std::uint32_t node = 1; node <= kMaxTreeDepth; ++node) deep.push_back({node, leaf});
  deep.push_back({leaf, leaf});
  refused(deep);
  deep.erase(deep.begin() + 1);
  for (std::size_t node = 0; node + 1 < deep.size(); ++node) deep[node][0] = static_cast<std::uint32_t>(node) + 1;
  EXPECT_EQ(decode_child_links(encode_child_links({deep, {}}), deep.size(), within(1)).nodes, deep);
}

TEST(TreeLinks, OfAWideTreeHaveEachTriangleOfTheScene) {
  Links wide;
  wide.slots = 4;
  wide.wide_nodes.assign(1, {});
  wide.wide_nodes[0].fill(kNoChild);
  wide.wide_nodes[0][0] = leaf_link(0, 2);
  wide.wide_nodes[0][3] = leaf_link(2, 3);
  const std::string bytes = encode_child_links(wide);
  EXPECT_EQ(decode_child_links(bytes, 1, {.triangles = 5, .textures = {}}, 4).wide_nodes, wide.wide_nodes);
  EXPECT_THROW(decode_child_links(bytes, 1, {.triangles = 6, .textures = {}}, 4), sim::InputError);
}

TEST(TreeLinks, OfTwoLevelsAreRestoredAndMustHaveTreesOfInstancesAndTriangles) {
  for (const Scene& scene : {scattered(80), scattered(1), Scene{}}) {
    const MemoryImage image = build_memory_image(scene, {.instances = InstanceLevels::kTwoLevel}, 1);
    const Links links = links_of(image);
    EXPECT_EQ(decode_child_links(encode_child_links(links), links.nodes.size(), counts_of(image)), links);
  }
  const auto says = [](auto&& change) {
    TileScope scope = tiny_levels();
    change(scope);
    try {
      decode_child_links(encode_child_links(scope.links), scope.links.nodes.size(), scope.counts);
    } catch (const sim::InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(says([](TileScope&) {}), "no error");
  EXPECT_EQ(says([](TileScope& s) { s.links.nodes[1][1] = instance_link(2); }), "tree: an instance is there twice");
  EXPECT_EQ(says([](TileScope& s) { s.links.nodes[1][1] = instance_link(4); }), "tree: a leaf is out of range");
  EXPECT_EQ(says([](TileScope& s) { s.links.nodes[1][1] = leaf_link(1, 2); }), "tree: a leaf is out of range");
  EXPECT_EQ(says([](TileScope& s) { s.links.nodes[1][1] = instance_link(3); }),
            "tree: an instance without a tree, or without a place");
  EXPECT_EQ(says([](TileScope& s) { s.links.roots[3] = 4; }), "tree: an instance without a tree, or without a place");
  EXPECT_EQ(says([](TileScope& s) { s.links.roots[1] = 2; }), "tree: a tree has no instance");
  EXPECT_EQ(says([](TileScope& s) {
              s.links.nodes[3][0] = 4;
              s.links.nodes[4][1] = leaf_link(5, 1);
            }),
            "tree: has not as many trees as it says");
  EXPECT_EQ(says([](TileScope& s) { s.links.nodes[1][1] = 2; }), "tree: a leaf is out of range");
  EXPECT_EQ(says([](TileScope& s) { s.counts.trees = 1; }), "tree: has not as many trees as it says");
  EXPECT_EQ(says([](TileScope& s) { s.counts.instances = 3; }), "tree: is longer than its nodes");
  EXPECT_EQ(says([](TileScope& s) { s.counts.instances = 5; }), "tree: number of instances is out of range");
}

/// Returns the number of nodes below `node`, which must have no other parent. Clears `sound` if a leaf contains an
/// invalid item.
std::size_t nodes_below(const TileScope& scope, std::uint32_t node, bool upper, std::vector<int>& entered,
                        bool& sound) {
  std::size_t nodes = 1;
  for (const std::uint32_t link : scope.links.nodes.at(node)) {
    if (is_leaf(link)) {
      sound = sound && is_instance(link) == upper;
      if (upper) entered.at(link_instance(link)) += 1;
      if (!upper) sound = sound && leaf_first(link) + leaf_count(link) <= scope.counts.triangles;
    } else if (link != kNoChild) {
      nodes += nodes_below(scope, link, upper, entered, sound);
    }
  }
  return nodes;
}

/// True if the tree is valid for traversals, restarts and prefetches.
bool is_sound(const TileScope& scope) {
  std::vector<int> entered(scope.counts.instances, 0);
  bool sound = true;
  std::size_t nodes = nodes_below(scope, 0, true, entered, sound);
  const std::set<std::uint32_t> roots(scope.links.roots.begin(), scope.links.roots.end());
  for (const std::uint32_t root : roots) {
    if (root != kNone) nodes += nodes_below(scope, root, false, entered, sound);
  }
  for (std::size_t i = 0; i < entered.size(); ++i)
    sound = sound && entered[i] == (scope.links.roots[i] != kNone ? 1 : 0);
  return sound && nodes == scope.links.nodes.size();
}

TEST(TreeLinks, AnyBytesGiveATreeOrAnError) {
  const TileScope scope = tiny_levels();
  const std::string good = encode_child_links(scope.links);
  std::size_t accepted = 0;
  Dice dice(8);
  for (int n = 0; n < 20000; ++n) {
    std::string bad = good;
    for (std::uint32_t changes = 1 + dice.below(3); changes > 0; --changes) {
      bad[dice.below(static_cast<std::uint32_t>(bad.size()))] = static_cast<char>(dice.below(64));
    }
    try {
      const Links links = decode_child_links(bad, scope.links.nodes.size(), scope.counts);
      ++accepted;
      EXPECT_EQ(decode_child_links(encode_child_links(links), links.nodes.size(), scope.counts), links);
      EXPECT_TRUE(is_sound({links, scope.counts, 1, {}}));
    } catch (const sim::InputError&) {
    }
  }
  EXPECT_GT(accepted, 100U);
}

}  // namespace
}  // namespace traces
