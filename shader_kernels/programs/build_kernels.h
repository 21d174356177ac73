#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/kernel_passes.h"
#include "traces/accel/memory_image.h"
#include "traces/accel/tree_builds.h"

namespace kernels {

// Building and refitting trees with kernels on the shader cores (build.engine: srp). Each tree of a frame has
// these passes; all trees of a frame run a pass together:
//
//   leaf, bounds --> code --> histogram --> scan --> scatter x digits --> link --> fit --> collapse --> encode
//   refit_leaves --> refit_nodes
//
// 1. Sort keys are Morton codes on a cubic grid over the centres of all triangles. A radix sort takes digits of eight
//    bits. One pass counts the values of all digits. Each scatter pass sorts a batch in the tile buffer, then writes
//    each digit's run of keys to its place. Batches pass their 256 counts on through memory to find that place.
// 2. The binary tree of n triangles has n - 1 nodes. encode_node writes those that the scene's tree has.
// 3. For wide trees, each item of collapse_node replaces the largest child of a wide node by that child's two children.
//    A wide node of c children takes c - 1 items.
// 4. For a tree over instances, kernels read each instance's matrix and its mesh's box. pose_instance writes the
// leaves.
// 5. A refit first writes leaf records and boxes of leaves. Then it updates the nodes, bottom up.

/// Adds the passes that build or refit the trees of a frame. `image` must have binary nodes of float pairs or wide
/// nodes, and leaf records of one triangle with its labels.
void add_build_passes(const traces::MemoryImage& image, const traces::TreeBuilds& builds, KernelPasses& passes);

/// Returns the end of the trees that `builds` writes, in bytes from the first node of the scene.
std::uint64_t end_of_trees(const traces::TreeBuilds& builds);

/// Results of running the kernels of a build on a scene's triangles.
struct KernelBuildResult {
  struct Key {
    std::uint32_t key = 0, number = 0;
  };
  std::vector<Key> keys, sorted;
  std::vector<std::uint32_t> parents;  ///< of each node of the hierarchy by sorting, in order of completion
  std::vector<traces::NodeRecord> nodes;
  std::vector<traces::TriangleRecord> leaves;
  std::uint64_t links = 0, unions = 0;  ///< items of link_node and of fit_node
};

/// Runs the kernels of a build on the host: sorts the image's triangles by codes of `morton_bits`, and writes its nodes
/// and leaf records from their boxes. Nodes have the links of the image, which has one level.
KernelBuildResult run_build_kernels(const traces::MemoryImage& image, std::uint32_t morton_bits);

/// Runs the refit kernels on the host. They use the triangles and node links of the memory image.
KernelBuildResult run_refit_kernels(const traces::MemoryImage& image);

}  // namespace kernels
