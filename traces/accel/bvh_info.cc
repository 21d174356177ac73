#include "traces/accel/bvh_info.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "sim/sha256.h"

namespace traces {

namespace {

template <class Record>
std::string digest_of(const std::vector<Record>& records) {
  return sim::sha256_hex({reinterpret_cast<const char*>(records.data()), records.size() * sizeof(Record)});
}

}  // namespace

std::string bvh_hash(const MemoryImage& image) {
  std::string parts = digest_of(image.nodes) + digest_of(image.triangles);
  if (image.has_two_levels()) parts += digest_of(image.instances);
  if (image.grid) parts += digest_of(std::vector{image.grid->lower_corner(), image.grid->plane_spacing()});
  return sim::sha256_hex(parts);
}

namespace {

double half_area(const NodeRecord& node, int child, const glm::vec3& step) {
  const double x = (double{node.x[2 + child]} - node.x[child]) * step.x;
  const double y = (double{node.y[2 + child]} - node.y[child]) * step.y;
  const double z = (double{node.z[2 + child]} - node.z[child]) * step.z;
  return x * y + y * z + z * x;
}

double half_area(const glm::vec3& lower, const glm::vec3& upper) {
  const double x = double{upper.x} - lower.x;
  const double y = double{upper.y} - lower.y;
  const double z = double{upper.z} - lower.z;
  return x * y + y * z + z * x;
}

double root_area(const NodeRecord& root) {
  return half_area({std::min(root.x[0], root.x[1]), std::min(root.y[0], root.y[1]), std::min(root.z[0], root.z[1])},
                   {std::max(root.x[2], root.x[3]), std::max(root.y[2], root.y[3]), std::max(root.z[2], root.z[3])});
}

/// Expected cost and depth of a tree, for a random line through its bounds.
struct TreeCost {
  double cost = 0;
  std::uint32_t depth = 0;
};

/// Returns the cost and depth of the tree in nodes [begin, end) of the BVH. `area`: surface area of the tree's bounds.
/// `below`: costs of the trees below its instance leaves.
TreeCost measure_tree(const MemoryImage& image, std::size_t begin, std::size_t end, double area,
                      const BvhConfig& config, const std::vector<TreeCost>& below, BvhInfo& info) {
  const glm::vec3 step = image.grid ? image.grid->plane_spacing() : glm::vec3(1);
  TreeCost tree;
  double cost = area * config.traversal_cost;
  // Nodes precede their children, so one forward pass finds every node's depth.
  std::vector<std::uint32_t> depth(end - begin, 1);
  for (std::size_t i = begin; i < end; ++i) {
    const NodeRecord& node = image.nodes[i];
    const std::uint32_t own = depth[i - begin];
    tree.depth = std::max(tree.depth, own);
    for (int c = 0; c < 2; ++c) {
      const std::uint32_t link = node.child[c];
      if (link == kNoChild) continue;
      if (is_instance(link)) {
        const TreeCost& entered = below[image.tree_of[link_instance(link)]];
        tree.depth = std::max(tree.depth, own + entered.depth);
        cost += half_area(node, c, step) * entered.cost;
      } else if (is_leaf(link)) {
        ++info.leaves;
        cost += half_area(node, c, step) * config.intersection_cost * leaf_count(link);
      } else {
        depth[link - begin] = own + 1;
        cost += half_area(node, c, step) * config.traversal_cost;
      }
    }
  }
  tree.cost = area > 0 ? cost / area : 0;
  return tree;
}

}  // namespace

BvhInfo bvh_info(const MemoryImage& image, const BvhConfig& config) {
  BvhInfo info;
  info.nodes = image.nodes.size();
  info.bytes = image.node_array_bytes() + image.instances.size() * sizeof(InstanceRecord) +
               image.triangles.size() * sizeof(TriangleRecord);  // includes the label words
  std::vector<TreeCost> objects;
  for (std::size_t k = 0; k < image.trees.size(); ++k) {
    const std::size_t begin = image.trees[k].first_node;
    const std::size_t end = k + 1 == image.trees.size() ? image.nodes.size() : image.trees[k + 1].first_node;
    objects.push_back(measure_tree(image, begin, end, root_area(image.nodes[begin]), config, {}, info));
  }
  const std::size_t top = image.trees.empty() ? image.nodes.size() : image.trees.front().first_node;
  const TreeCost all = measure_tree(image, 0, top, half_area(image.lower, image.upper), config, objects, info);
  info.depth = all.depth;
  info.sah_cost = all.cost;
  return info;
}

}  // namespace traces
