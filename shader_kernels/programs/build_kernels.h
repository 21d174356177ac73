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
// 1. Keys are Morton codes on a cubic grid over all centres, sorted by digits of eight bits. One pass counts all
//    digits. A pass that scatters exchanges its 256 counts with the batches before it through memory. It sorts a batch
//    in the tile buffer, and writes each digit's run of keys to its place.
// 2. The hierarchy has one node per triangle less one; encode_node writes the nodes that the scene's tree has.
// 3. For wide trees, each item of collapse_node opens the largest child of a wide node. A node of c children takes
//    c - 1 items.
// 4. A tree over instances reads a matrix and the mesh's box of each. pose_instance writes its leaves.
// 5. A refit writes leaf records and boxes of leaves, then nodes, bottom up.

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

/// Runs the kernels of a refit on the host, on the image's triangles and the links of its nodes.
KernelBuildResult run_refit_kernels(const traces::MemoryImage& image);

}  // namespace kernels
