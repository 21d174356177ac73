#pragma once
#include <cstdint>
#include <vector>

#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Where the records of nodes, leaves and instances are within their arrays, as Layout::node_places and its neighbours.
///
/// 1. A leaf record contains one triangle, or with pairs and blocks the triangles from one that begins a record to the
///    next.
/// 2. In q12 and cw80 a node has one base for its leaves, so instance records are in the order of the tree.
/// 3. In q8 a node has one base for all children: its inner children are followed by the records of its leaves, filled
///    up to a line of 64 bytes.
struct TreePlaces {
  std::vector<std::uint32_t> nodes, triangles, instances;
  std::uint64_t node_bytes = 0;  ///< size of the array of nodes; in q8 of all three
  std::uint64_t leaf_bytes = 0;  ///< size of all leaf records
  bool one_array = false;
};

TreePlaces place_tree(const ImageCounts& counts, const MemoryImage& image, const BvhConfig& config);

/// Returns the size in bytes of a leaf record.
constexpr std::uint32_t leaf_record_bytes(const BvhConfig& config) {
  return config.leaf == LeafFormat::kPair64 ? 64 : config.leaf == LeafFormat::kBlock128 ? 128 : config.triangle_bytes;
}

}  // namespace traces
