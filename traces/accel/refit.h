#pragma once
#include "sim/stop.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Fits the boxes of nodes [first, end), which are whole trees, to their triangles.
void fit_boxes(MemoryImage& image, std::size_t first, std::size_t end);

/// Updates the image of a scene that has moved, by refit or rebuild as configured.
void update_memory_image(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                         sim::Stop stop = nullptr);

/// Updates a one-level image to a moved scene: triangles, attributes, boxes, scene bounds and lights are recomputed;
/// the tree, leaf order and addresses stay. The result depends on `posed` and the tree alone, not on earlier refits.
/// The more the scene has moved since the build, the more boxes overlap. `posed` must have the instances and triangles
/// of the build.
void refit_memory_image(const Scene& posed, MemoryImage& image);

}  // namespace traces
