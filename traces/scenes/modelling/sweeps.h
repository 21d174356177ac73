#pragma once
#include <span>
#include <string>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Makes a solid of revolution about +y. The profile's points are (radius, height), bottom to top for normals outwards.
/// Edges stay sharp where the profile turns by more than about 40 degrees. Texture u runs round, v along.
Mesh make_lathe(std::string name, std::span<const glm::vec2> profile, std::uint32_t segments);

/// Returns a Catmull-Rom curve through all points, `steps` points per section.
std::vector<glm::vec2> smoothed(std::span<const glm::vec2> points, std::uint32_t steps);
std::vector<glm::vec3> smoothed(std::span<const glm::vec3> points, std::uint32_t steps);

/// Makes a cylinder along +y from y = 0, with caps.
Mesh make_cylinder(std::string name, float radius, float height, std::uint32_t segments);
/// Makes a cone along +y, closed below; `top_radius` 0 gives a point.
Mesh make_cone(std::string name, float radius, float top_radius, float height, std::uint32_t segments);
/// Makes a ring in the xz plane.
Mesh make_torus(std::string name, float radius, float tube_radius, std::uint32_t segments, std::uint32_t sides);

/// Makes a round tube along a path. `radii` has one entry, or one per point. Flat caps close the ends unless the radius
/// there is 0.
Mesh make_tube(std::string name, std::span<const glm::vec3> path, std::span<const float> radii, std::uint32_t sides);

/// Makes a prism: the outline (counter-clockwise in the xy plane, simple, may be concave) from z = 0 to z = depth.
Mesh make_extrusion(std::string name, std::span<const glm::vec2> outline, float depth);

}  // namespace traces
