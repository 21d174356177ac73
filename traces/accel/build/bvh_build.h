#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/stop.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/bounds.h"

namespace traces {

/// A tree in its final order: depth first, the child of larger surface area (child 0) right behind its parent.
struct FlatBvh {
  std::vector<NodeRecord> nodes;
  std::vector<std::uint32_t> order;  ///< what was given, as the leaves want it, by index into the input
};

inline void set_box(NodeRecord& node, int child, const Bounds& b) {
  for (auto [lanes, axis] : {std::pair{node.x, 0}, {node.y, 1}, {node.z, 2}}) {
    lanes[child] = b.lower[axis];
    lanes[2 + child] = b.upper[axis];
  }
}

/// Embree's builder, for one tree after another.
class BvhBuilder {
 public:
  /// `stop`: asked now and then; sim::Cancelled once it says true.
  BvhBuilder(const BvhConfig& config, unsigned threads, sim::Stop stop = nullptr);
  ~BvhBuilder();
  /// InputError if the tree would be too deep.
  FlatBvh over(std::span<const TriangleRecord> triangles) const;
  /// A tree with a leaf for each box, none of which is empty.
  FlatBvh over(std::span<const Bounds> boxes) const;

 private:
  struct Device;
  const BvhConfig config_;
  const sim::Stop stop_;
  const std::unique_ptr<const Device> device_;
};

}  // namespace traces
