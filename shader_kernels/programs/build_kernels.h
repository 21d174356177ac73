#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "traces/accel/memory_image.h"
#include "traces/stream.h"

namespace kernels {

// Building a binary tree with kernels on the shader cores (build.engine: srp).
//
//   build_leaf --> sort_histogram --> sort_scan --> sort_scatter x 3 --> link_node --> fit_node --> encode_node, _leaf
//
// 1. A pass launches a kernel over all triangles, keys or nodes, batch by batch. Each batch reads its inputs into the
//    tile buffer by transfers, launches the kernel, and writes its outputs. Passes are separated by barriers.
// 2. Keys are 24-bit Morton codes, sorted by digits of eight bits. One pass counts all digits. A pass that scatters
//    exchanges its 256 counts with the batches before it through memory.
// 3. The hierarchy has one node per triangle less one; encode_node writes the nodes that the scene's tree has.

/// Bytes that a pass of the build reads or writes, in equal shares for all items.
struct BuildStream {
  traces::Region region = traces::Region::kBuild;
  bool is_written = false;
  std::uint64_t base = 0;   ///< offset of the first item's bytes within the region
  std::uint64_t bytes = 0;  ///< bytes of all items
  bool by_batch = false;    ///< `bytes` are those of each batch, such as counts of its keys
};

/// One pass of the build: kernels that are launched over the same items.
struct KernelPass {
  const char* name = "";
  std::vector<traces::KernelId> kernels;
  std::uint64_t items = 0;
  std::vector<BuildStream> streams;
  std::uint32_t batch = 1;  ///< items of one entry of the tile list

  std::uint32_t entry_count() const { return static_cast<std::uint32_t>((items + batch - 1) / batch); }
  /// Returns the bytes that all batches read and write.
  std::uint64_t moved_bytes() const;
};

/// Plan of a tree's build with kernels: passes and the memory that they need.
class KernelBuild {
 public:
  /// `image` must be a one-level binary tree of float pairs. `space`: bytes of the tile buffer for a batch.
  KernelBuild(const traces::MemoryImage& image, std::uint32_t space);

  const std::vector<KernelPass>& passes() const { return passes_; }
  std::uint32_t entry_count() const;
  std::uint64_t scratch_bytes() const { return scratch_; }
  std::uint64_t tree_bytes() const { return tree_; }
  /// Records an entry of the tile list: one batch of a pass. Sets `after_all` if the entry begins a pass.
  void record_entry(std::uint32_t entry, StreamBuilder& stream, traces::TileWork& work) const;

 private:
  std::uint64_t reserve(std::uint64_t bytes);

  std::vector<KernelPass> passes_;
  std::uint64_t scratch_ = 0, tree_ = 0;
};

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

/// Runs the kernels of a build on the host: sorts the image's triangles, and writes its nodes and leaf records from
/// their boxes. Nodes have the links of the image.
KernelBuildResult run_build_kernels(const traces::MemoryImage& image);

}  // namespace kernels
