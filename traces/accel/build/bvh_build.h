#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "traces/accel/build/build_statistics.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/bounds.h"

namespace traces {

/// A tree in its final order: depth first, and the child of larger surface area (child 0) directly after its parent.
struct FlatBvh {
  std::vector<NodeRecord> nodes;
  std::vector<std::uint32_t> order;  ///< input indices of the triangles or boxes, in leaf order
  BuildStatistics statistics;
};

/// Returns half the surface area of a box.
inline double half_surface(const Bounds& b) {
  if (b.empty()) return 0;
  const double x = double{b.upper.x} - b.lower.x, y = double{b.upper.y} - b.lower.y, z = double{b.upper.z} - b.lower.z;
  return x * y + y * z + z * x;
}

inline void set_box(NodeRecord& node, int child, const Bounds& b) {
  for (auto [lanes, axis] : {std::pair{node.x, 0}, {node.y, 1}, {node.z, 2}}) {
    lanes[child] = b.lower[axis];
    lanes[2 + child] = b.upper[axis];
  }
}

inline void set_box(WideNode& node, std::uint32_t slot, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis) {
    node.planes[axis][0][slot] = b.lower[axis];
    node.planes[axis][1][slot] = b.upper[axis];
  }
}

/// Builds bounding volume hierarchies with the algorithm that `bvh.builder` selects. The tree does not depend on the
/// number of threads.
class BvhBuilder {
 public:
  /// The BVH build polls `stop` and throws sim::Cancelled once `stop` returns true.
  BvhBuilder(const BvhConfig& config, unsigned threads, sim::Stop stop = nullptr);
  ~BvhBuilder();
  /// Builds a BVH over triangles. Throws InputError if the tree is too deep.
  FlatBvh build_over(std::span<const TriangleRecord> triangles) const;
  /// Builds a BVH over boxes, with one box per leaf. No box may be empty.
  FlatBvh build_over(std::span<const Bounds> boxes) const;

 private:
  struct Device;
  FlatBvh build_tree(std::span<const Bounds> boxes, const BvhConfig& config) const;

  const BvhConfig config_;
  const sim::Stop stop_;
  const std::unique_ptr<const Device> device_;  ///< null unless Embree builds the trees
};

/// Moves record order[i] to index i for all i, in place, along the cycles of the permutation.
template <class Record>
void reorder_records(std::span<Record> records, const std::vector<std::uint32_t>& order) {
  std::vector<bool> done(records.size(), false);
  for (std::uint32_t start = 0; start < order.size(); ++start) {
    if (done[start]) continue;
    const Record first = records[start];
    std::uint32_t to = start;
    for (std::uint32_t from = order[to]; from != start; to = from, from = order[to]) {
      records[to] = records[from];
      done[to] = true;
    }
    records[to] = first;
    done[to] = true;
  }
}

}  // namespace traces
