#pragma once
#include <cstdint>

#include "traces/scene/scene.h"

namespace traces::car {

/// What lies on the body: windows, lights, grilles, gaps, mirrors, handles, number plates, exhausts; hung on the node.
void add_trim(Scene& scene, const Mesh& shell, const Mesh& cabin, std::uint32_t node, std::uint32_t lacquer,
              double detail);

/// About how many triangles that adds.
std::uint64_t triangles_of_trim(double detail);

}  // namespace traces::car
