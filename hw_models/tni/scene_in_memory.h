#pragma once
#include <cstdint>
#include <span>

#include "hw_models/tni/tni_core.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// The scene of an image as a T&I unit knows it; `parents` comes from traces::parents_of(). Both must outlive it.
inline TniCore::Scene scene_in_memory(const traces::MemoryImage& image, std::span<const std::uint32_t> parents) {
  const traces::Layout& layout = image.layout;
  return {{.nodes = layout.nodes,
           .node_bytes = layout.node_bytes,
           .parents = parents,
           .single_boxes = layout.single_boxes,
           .hybrid = image.grid.has_value(),
           .links = image.nodes,
           .instances = layout.instances,
           .placed = image.instances},
          {layout.triangles, layout.triangle_bytes}};
}

}  // namespace hw
