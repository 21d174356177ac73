#pragma once
#include <functional>
#include <span>
#include <string>

#include "traces/scene/scene.h"

namespace traces {

// Parts of rooms and buildings, on top of shapes.h and sweeps.h.

/// Axes of things that stand at a wall: x to the right and y up as seen from the room, z = `outward` (horizontal, of
/// unit length) out of the wall.
glm::mat4 standing(const glm::vec3& origin, const glm::vec3& outward);
/// The same for what lies on a floor (x, y = -z of the world) or hangs under a ceiling (x, y = z of the world).
glm::mat4 lying(const glm::vec3& origin);
glm::mat4 hanging(const glm::vec3& origin);
/// Rotation about an axis of unit length through `origin`.
glm::mat4 turned(const glm::vec3& origin, const glm::vec3& axis, double turns);

/// A plate in relief, z outwards, its lower left corner at the origin: rectangles inside each other, each given by its
/// distance from the rim and its height, joined by flat faces; the last one is filled with cells x cells squares.
Mesh make_panel(std::string name, float width, float height, std::span<const glm::vec2> rings, std::uint32_t cells = 1);

/// Like make_rounded_box, but the flat parts cut into cells x cells, to be warped.
Mesh make_cushion(std::string name, const glm::vec3& lower, const glm::vec3& upper, float radius, std::uint32_t steps,
                  std::uint32_t cells);

/// Every point carried to where `to` says; normals follow. `to` must be smooth and may not turn things inside out.
Mesh warped(Mesh mesh, const std::function<glm::vec3(const glm::vec3&)>& to);

/// Texture coordinates in units of length: those of the plane that the normal is nearest to. `upright`: u upwards on
/// what stands, so that the grain of wood does too.
void project_uvs(Mesh& mesh, float repeats, bool upright = false);

/// Cloth that hangs in `folds` waves of `depth`, from y = height to y = 0 and x = 0 to x = width, gathered above.
Mesh make_curtain(std::string name, float width, float height, std::uint32_t folds, float depth, std::uint32_t columns,
                  std::uint32_t rows, std::uint32_t seed);

/// Rounded outline |x / a|^8 + |y / b|^8 = 1, counter-clockwise: between an ellipse and a rectangle.
glm::vec2 on_rounded_rectangle(double turns, float a, float b);

/// A leaf: a blade that rises along `direction` (unit, need not be horizontal) and bends down under its weight by
/// `droop` times its length, added to `mesh`.
void add_leaf(Mesh& mesh, const glm::vec3& base, const glm::vec3& direction, float length, float width, float droop,
              std::uint32_t rows);

}  // namespace traces
