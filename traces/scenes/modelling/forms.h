#pragma once
#include <functional>
#include <span>
#include <string>

#include "traces/scene/scene.h"

namespace traces {

// Parts of rooms and buildings, based on shapes.h.

/// Returns the axes of a wall: x to the right and y up as seen from the room, z = `outward` (horizontal unit vector)
/// out of the wall.
glm::mat4 wall_axes(const glm::vec3& origin, const glm::vec3& outward);
/// Return the axes of a floor and of a ceiling. The x axis is that of the world. The y axis of a floor is the world's
/// -z; that of a ceiling is the world's z.
glm::mat4 floor_axes(const glm::vec3& origin);
glm::mat4 ceiling_axes(const glm::vec3& origin);
/// Returns a rotation about an axis (a unit vector) through `origin`.
glm::mat4 rotation_about(const glm::vec3& origin, const glm::vec3& axis, double turns);

/// Makes a plate in relief with its lower left corner at the origin, z outwards. `rings` are nested rectangles, each
/// given by distance from the rim and height, joined by flat faces; the innermost is filled with cells x cells squares.
Mesh make_panel(std::string name, float width, float height, std::span<const glm::vec2> rings, std::uint32_t cells = 1);

/// Makes a rounded box to be deformed with warp_mesh(). Its flat parts have cells x cells squares.
Mesh make_cushion(std::string name, const glm::vec3& lower, const glm::vec3& upper, float radius, std::uint32_t steps,
                  std::uint32_t cells);

/// Returns the mesh deformed by `to`, which maps old to new positions; normals follow. `to` must be smooth and must not
/// turn the mesh inside out.
Mesh warp_mesh(Mesh mesh, const std::function<glm::vec3(const glm::vec3&)>& to);

/// Sets texture coordinates by projecting positions onto the coordinate plane to which the normal is most
/// perpendicular. `repeats` is the number of repetitions per unit of length. `upright` makes u point up on vertical
/// faces, so that wood grain does too.
void project_uvs(Mesh& mesh, float repeats, bool upright = false);

/// Makes a curtain with `folds` waves of `depth`, from y = height to y = 0 and x = 0 to x = width, gathered at the top.
Mesh make_curtain(std::string name, float width, float height, std::uint32_t folds, float depth, std::uint32_t columns,
                  std::uint32_t rows, std::uint32_t seed);

/// Returns a point of |x / a|^8 + |y / b|^8 = 1, an outline between ellipse and rectangle, counter-clockwise.
glm::vec2 rounded_rectangle_point(double turns, float a, float b);

/// Adds a leaf to `mesh`: a blade along the unit vector `direction` that bends down by `droop` times its length.
void add_leaf(Mesh& mesh, const glm::vec3& base, const glm::vec3& direction, float length, float width, float droop,
              std::uint32_t rows);

}  // namespace traces
