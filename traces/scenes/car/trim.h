#pragma once
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

/// Adds the parts on the body: windows, lights, grilles, gaps, mirrors, handles, number plates, exhausts; hung on the
/// node.
void add_trim(Scene& scene, const Mesh& shell, const Mesh& cabin, std::uint32_t node, std::uint32_t lacquer,
              const Detail& detail);

/// About how many triangles that adds.
std::uint64_t triangles_of_trim(const Detail& detail);

}  // namespace traces::car
