#pragma once
#include "sim/error.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Builds the memory image of a scene: flattens its instances to world space, builds the BVH and lays out all arrays.
/// The result does not depend on the number of threads (0: all). With mip maps, textures get all their levels. A
/// triangle without area is kept as a point that no ray can hit. Throws sim::InputError for invalid references or a
/// scene that is too large, and sim::Cancelled if `stop` returns true.
MemoryImage build_memory_image(const Scene& scene, const BvhConfig& config = {}, unsigned threads = 0,
                               sim::Stop stop = nullptr, MipMaps mip_maps = MipMaps::kOff,
                               Roughness roughness = Roughness::kOff);

/// Returns the tree, triangles and layout of a one-level image of float pairs in the format that `config` selects. The
/// result has no shading records. `config` must have the binary tree's keys: leaf size, depth and costs.
MemoryImage reformat_tree(const MemoryImage& binary, const BvhConfig& config);

/// Recomputes the boxes of nodes [first, end) of an image from their triangles. The nodes must form whole trees.
void recompute_boxes(MemoryImage& image, std::size_t first, std::size_t end);

/// Updates the memory image of a scene that has moved, by refit or rebuild as BvhConfig selects.
void update_memory_image(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                         sim::Stop stop = nullptr);

/// Refits a one-level image to a scene that has moved. Triangles, attributes, boxes, scene bounds and lights are
/// recomputed; the tree, leaf order and addresses stay. The result depends on `posed` and the tree, not on earlier
/// refits. The farther the scene has moved since the build, the more boxes overlap. `posed` must have the instances and
/// triangles of the build.
void refit_memory_image(const Scene& posed, MemoryImage& image);

}  // namespace traces
