#include "traces/accel/bvh_info.h"

#include <algorithm>
#include <cassert>
#include <span>
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
  std::string parts =
      (image.is_wide() ? digest_of(image.wide_nodes) : digest_of(image.nodes)) + digest_of(image.triangles);
  if (image.has_two_levels()) parts += digest_of(image.instances);
  if (image.grid) parts += digest_of(std::vector{image.grid->lower_corner(), image.grid->plane_spacing()});
  if (!image.begins_record.empty())
    parts += digest_of(std::vector<char>(image.begins_record.begin(), image.begins_record.end()));
  return sim::sha256_hex(parts);
}

namespace {

/// Returns half the area of a child's box. `step` converts planes to distances.
double half_area(const MemoryImage& image, std::size_t index, int child, const glm::vec3& step) {
  double size[3];
  for (int a = 0; a < 3; ++a) {
    if (image.is_wide()) {
      const auto& [lower, upper] = image.wide_nodes[index].planes[a];
      size[a] = (double{upper[child]} - lower[child]) * step[a];
    } else {
      const NodeRecord& node = image.nodes[index];
      const float* planes = a == 0 ? node.x : a == 1 ? node.y : node.z;
      size[a] = (double{planes[2 + child]} - planes[child]) * step[a];
    }
  }
  return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

double half_area(const glm::vec3& lower, const glm::vec3& upper) {
  const double x = double{upper.x} - lower.x;
  const double y = double{upper.y} - lower.y;
  const double z = double{upper.z} - lower.z;
  return x * y + y * z + z * x;
}

double root_area(const MemoryImage& image, std::uint32_t root) {
  const Bounds bounds = tree_bounds(image, root);
  return half_area(bounds.lower, bounds.upper);
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
    const std::span<const std::uint32_t> links = image.links_of(static_cast<std::uint32_t>(i));
    const std::uint32_t own = depth[i - begin];
    tree.depth = std::max(tree.depth, own);
    for (int c = 0; c < static_cast<int>(links.size()); ++c) {
      const std::uint32_t link = links[static_cast<std::size_t>(c)];
      if (link == kNoChild) continue;
      ++info.children;
      const double box = half_area(image, i, c, step);
      if (is_instance(link)) {
        const TreeCost& entered = below[image.tree_of[link_instance(link)]];
        tree.depth = std::max(tree.depth, own + entered.depth);
        cost += box * entered.cost;
      } else if (is_leaf(link)) {
        ++info.leaves;
        info.leaf_triangles += leaf_count(link);
        cost += box * config.intersection_cost * leaf_count(link);
      } else {
        depth[link - begin] = own + 1;
        cost += box * config.traversal_cost;
      }
    }
  }
  tree.cost = area > 0 ? cost / area : 0;
  return tree;
}

/// Measures all trees; the results are in the order of MemoryImage::build_statistics.
std::vector<TreeCost> measure_trees(const MemoryImage& image, const BvhConfig& config, BvhInfo& info) {
  std::vector<TreeCost> objects;
  for (std::size_t k = 0; k < image.trees.size(); ++k) {
    const std::size_t begin = image.trees[k].first_node;
    const std::size_t end = k + 1 == image.trees.size() ? image.node_count() : image.trees[k + 1].first_node;
    objects.push_back(measure_tree(image, begin, end, root_area(image, image.trees[k].first_node), config, {}, info));
  }
  const std::size_t top = image.trees.empty() ? image.node_count() : image.trees.front().first_node;
  const double area = half_area(image.lower, image.upper);
  const TreeCost all = measure_tree(image, 0, top, area, config, objects, info);
  objects.insert(objects.begin(), all);
  return objects;
}

std::uint64_t tree_bytes(const MemoryImage& image) {
  return image.layout.tree_bytes + (image.layout.has_labels() ? image.triangles.size() * Layout::kLabelBytes : 0);
}

}  // namespace

BvhInfo bvh_info(const MemoryImage& image, const BvhConfig& config) {
  BvhInfo info;
  info.nodes = image.node_count();
  info.slots = info.nodes * image.width;
  info.bytes = tree_bytes(image);
  const TreeCost all = measure_trees(image, config, info).front();
  info.depth = all.depth;
  info.sah_cost = all.cost;
  return info;
}

double bytes_per_triangle(const MemoryImage& image) {
  if (image.triangles.empty()) return 0;
  return static_cast<double>(tree_bytes(image)) / static_cast<double>(image.triangles.size());
}

std::vector<double> tree_costs(const MemoryImage& image, const BvhConfig& config) {
  BvhInfo info;
  std::vector<double> costs;
  for (const TreeCost& tree : measure_trees(image, config, info)) costs.push_back(tree.cost);
  return costs;
}

std::vector<double> cost_growth(const std::vector<double>& built, const std::vector<double>& refitted) {
  assert(built.size() == refitted.size());
  std::vector<double> growth(built.size(), 1);
  for (std::size_t i = 0; i < built.size(); ++i) {
    if (built[i] > 0) growth[i] = refitted[i] / built[i];
  }
  return growth;
}

}  // namespace traces
