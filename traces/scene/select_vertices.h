#pragma once
#include <cstdint>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Replaces the vertices of a mesh: new vertex i is a copy of old vertex from[i]. Triangles are unchanged.
void select_vertices(Mesh& mesh, const std::vector<std::uint32_t>& from);

}  // namespace traces
