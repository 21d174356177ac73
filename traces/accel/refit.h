#pragma once
#include "sim/stop.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Draws the boxes of nodes from `first` to before `end`, whole trees, around their triangles.
void fit_boxes(MemoryImage& image, std::size_t first, std::size_t end);

/// Brings the image of a scene that has moved up to date, refitted or rebuilt as the configuration says.
void update_memory_image(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                         sim::Stop stop = nullptr);

/// Carries a moved scene into its memory image of one level: triangles, attributes, boxes, scene bounds and lights are
/// computed anew, while the tree, the order of its leaves and all addresses stay. The tree is valid for any motion, but
/// made for where the scene was when it was built: the further things move, the more its boxes overlap. Depends on
/// `posed` and the tree alone, not on earlier refits. `posed` has the instances and triangles that the image was built
/// from.
void refit_memory_image(const Scene& posed, MemoryImage& image);

}  // namespace traces
