#pragma once
#include "traces/accel/memory_image.h"

namespace traces {

/// Carries a moved scene into its memory image: triangles, attributes, boxes, scene bounds and lights are computed
/// anew, while the tree, the order of its leaves and all addresses stay. The tree is valid for any motion, but made for
/// where the scene was when it was built: the further things move, the more its boxes overlap. Depends on `posed` and
/// the tree alone, not on earlier refits. `posed` has the instances and triangles that the image was built from.
void refit_memory_image(const Scene& posed, MemoryImage& image);

}  // namespace traces
