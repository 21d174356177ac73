#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "traces/accel/build_config.h"
#include "traces/accel/memory_image.h"
#include "traces/accel/pose_work.h"
#include "traces/stream.h"

namespace traces {

/// Work of building or refitting one tree of a memory image.
struct TreeBuild {
  std::uint32_t items = 0;  ///< triangles or instances of the tree
  BuildWork job;
  std::vector<std::array<std::uint32_t, 3>>
      triangles;                     ///< vertex numbers in input order; empty for a tree of instances
  std::vector<std::uint32_t> order;  ///< input numbers of the triangles, in leaf order
};

/// The trees that a frame builds and refits.
struct TreeBuilds {
  BuildEngine engine = BuildEngine::kUnit;
  std::uint32_t morton_bits = 30;  ///< bits of the keys by which kernels sort
  PoseWork pose;                   ///< work of kernels before the trees, with any engine
  std::vector<TreeBuild> trees;
  BuildArraySizes sizes;
};

/// Returns the work for the trees of an image whose scene has moved.
///
/// 1. With one level, this is the only tree, built or refitted.
/// 2. With two levels, the tree over instances is always built. Trees of meshes that deform or are stored in world
/// space
///    are built or refitted. Shared meshes do not move.
/// 3. Triangles share vertices with bit-identical positions. Vertices are numbered in order of first use by the input.
///
/// 4. A tree that bvh.builder: ploc built compares each cluster with `ploc_radius` neighbours in each round, because a
///    pair is compared once.
///
/// `overlap`: the trees are written to a second copy. Throws InputError for a layout that stores two levels with single
/// boxes.
TreeBuilds tree_builds(const MemoryImage& image, bool refit, bool overlap, std::uint32_t ploc_radius = 16);

/// Replaces the work of an entry of the tile list by one node that builds a tree.
void set_build_arrays(const TreeBuild& build, TileWork& work);

}  // namespace traces
