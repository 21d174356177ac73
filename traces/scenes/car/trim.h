#pragma once
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

/// Adds the parts on the body, attached to the node: windows, lights, grilles, gaps, mirrors, handles, number plates,
/// exhausts.
void add_trim(Scene& scene, const Mesh& shell, const Mesh& cabin, std::uint32_t node, std::uint32_t lacquer,
              const Detail& detail);

/// Returns the approximate number of triangles that add_trim() adds.
std::uint64_t triangles_of_trim(const Detail& detail);

}  // namespace traces::car
