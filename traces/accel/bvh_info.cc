#include "traces/accel/bvh_info.h"

#include <algorithm>
#include <vector>

namespace traces {
namespace {

double half_area(const NodeRecord& node, int child, const glm::vec3& step) {
  const double x = (double{node.x[2 + child]} - node.x[child]) * step.x;
  const double y = (double{node.y[2 + child]} - node.y[child]) * step.y;
  const double z = (double{node.z[2 + child]} - node.z[child]) * step.z;
  return x * y + y * z + z * x;
}

}  // namespace

BvhInfo bvh_info(const MemoryImage& image, const BvhConfig& config) {
  BvhInfo info;
  info.nodes = image.nodes.size();
  info.bytes = image.node_array_bytes() + image.triangles.size() * sizeof(TriangleRecord);  // labels are a part of it
  const glm::vec3 step = image.grid ? image.grid->step() : glm::vec3(1);
  const double x = double{image.upper.x} - image.lower.x;
  const double y = double{image.upper.y} - image.lower.y;
  const double z = double{image.upper.z} - image.lower.z;
  const double root_area = x * y + y * z + z * x;
  double cost = root_area * config.traversal_cost;

  // A parent lies before its children, so one pass from the front knows every depth.
  std::vector<std::uint32_t> depth(image.nodes.size(), 1);
  for (std::size_t i = 0; i < image.nodes.size(); ++i) {
    const NodeRecord& node = image.nodes[i];
    info.depth = std::max(info.depth, depth[i]);
    for (int c = 0; c < 2; ++c) {
      const std::uint32_t link = node.child[c];
      if (link == kNoChild) continue;
      if (is_leaf(link)) {
        ++info.leaves;
        cost += half_area(node, c, step) * config.intersection_cost * leaf_count(link);
      } else {
        depth[link] = depth[i] + 1;
        cost += half_area(node, c, step) * config.traversal_cost;
      }
    }
  }
  info.sah_cost = root_area > 0 ? cost / root_area : 0;
  return info;
}

}  // namespace traces
