#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

// Basic shapes. They use only +, *, /, square roots and trigonometry.h, so that every compiler and library gives the
// same bits. All have normals and texture coordinates; front faces are counter-clockwise seen from outside.

/// Makes a parallelogram with corners `corner`, `corner + u` and `corner + v`, divided into cells x cells parts. The
/// normal is along u x v; texture coordinates run from 0 to `repeats`.
Mesh make_quad(std::string name, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, std::uint32_t cells,
               float repeats = 1);

/// Makes a sphere by projecting a cube of six cells x cells faces. Normals point outwards.
Mesh make_sphere(std::string name, const glm::vec3& centre, float radius, std::uint32_t cells);

/// Makes a box between two corners, with cells x cells squares on each face. Texture coordinates run over each face,
/// `repeats` per unit of length.
Mesh make_box(std::string name, const glm::vec3& lower, const glm::vec3& upper, std::uint32_t cells = 1,
              float repeats = 1);

/// Makes a box whose edges and corners are rounded with `radius`, each edge in `steps` strips.
Mesh make_rounded_box(std::string name, const glm::vec3& lower, const glm::vec3& upper, float radius,
                      std::uint32_t steps);

/// Makes the surface `at(s, t)` over the unit square in columns x rows cells, with smooth normals along ds x dt.
/// Degenerate cells are omitted. `closed_s` means that s = 1 coincides with s = 0.
Mesh make_surface(std::string name, std::uint32_t columns, std::uint32_t rows,
                  const std::function<glm::vec3(float s, float t)>& at, bool closed_s = false);

/// Adds two triangles for each cell of a (columns + 1) x (rows + 1) grid of vertices that begins at vertex `first`.
void add_grid(Mesh& mesh, std::uint32_t first, std::uint32_t columns, std::uint32_t rows);

/// Adds all vertices and triangles of `other` to `mesh`. The material of `other` is ignored.
void append_mesh(Mesh& mesh, const Mesh& other);
/// Returns a mesh transformed by a rotation, scale or mirroring. Normals of a mirrored mesh still point outwards.
Mesh transform_mesh(Mesh mesh, const glm::mat4& by);
glm::mat4 placement_at(const glm::vec3& position, double turns_about_y = 0, const glm::vec3& scale = glm::vec3(1));
void scale_uvs(Mesh& mesh, const glm::vec2& by);

/// Adds a mesh with a material to the scene and returns its index. add_instance() shows it, any number of times.
std::uint32_t add_mesh(Scene& scene, Mesh mesh, std::uint32_t material);
/// Adds an instance of a mesh and returns its index. attach_to_node() (motion.h) makes it move.
std::uint32_t add_instance(Scene& scene, std::uint32_t mesh, const glm::mat4& to_world = glm::mat4(1));

/// Adds a mesh with its material, and one instance without a transform.
void add_object(Scene& scene, Mesh mesh, std::uint32_t material);

std::uint32_t add_material(Scene& scene, Material material);
std::uint32_t add_texture(Scene& scene, Texture texture);
/// Adds a texture and a diffuse material of the same name that shows it. Returns the index of the material.
std::uint32_t add_textured(Scene& scene, Texture texture, float mirror = 0);
/// Makes a diffuse material. If `mirror` is above 0, it is glossy.
Material make_paint(std::string name, const glm::vec3& colour, float mirror = 0);
/// Makes a metal that mirrors the fraction `mirror` of the light, tinted.
Material make_metal(std::string name, const glm::vec3& tint, float mirror = 0.8F);
Material make_glass(std::string name, const glm::vec3& colour = glm::vec3(1), float ior = 1.5F);
Material make_lamp(std::string name, const glm::vec3& emission);
/// Makes a diffuse material that shows texture `texture`.
Material make_textured(std::string name, std::uint32_t texture, const glm::vec3& colour = glm::vec3(1),
                       float mirror = 0);

/// Returns the number of triangles in a scene. A mesh counts once for each of its instances.
std::uint64_t count_triangles(const Scene& scene);

/// Makes a solid of revolution about +y. The points of the profile are (radius, height), bottom to top for normals
/// outwards. Edges stay sharp where the profile turns by more than about 40 degrees. Texture u runs around, v along.
Mesh make_lathe(std::string name, std::span<const glm::vec2> profile, std::uint32_t segments);

/// Returns a Catmull-Rom curve through all points, `steps` points per section.
std::vector<glm::vec2> catmull_rom(std::span<const glm::vec2> points, std::uint32_t steps);
std::vector<glm::vec3> catmull_rom(std::span<const glm::vec3> points, std::uint32_t steps);

/// Makes a cylinder along +y from y = 0, with caps.
Mesh make_cylinder(std::string name, float radius, float height, std::uint32_t segments);
/// Makes a cone along +y, closed below. With a `top_radius` of 0 the cone has a point.
Mesh make_cone(std::string name, float radius, float top_radius, float height, std::uint32_t segments);
/// Makes a torus around the y axis.
Mesh make_torus(std::string name, float radius, float tube_radius, std::uint32_t segments, std::uint32_t sides);

/// Makes a round tube along a path. `radii` has one entry, or one per point. Flat caps close ends whose radius is not
/// 0.
Mesh make_tube(std::string name, std::span<const glm::vec3> path, std::span<const float> radii, std::uint32_t sides);

/// Makes a prism from an outline in the xy plane, from z = 0 to z = depth. The outline is counter-clockwise and simple,
/// and may be concave.
Mesh make_extrusion(std::string name, std::span<const glm::vec2> outline, float depth);

/// Builds the profile of a turned object (make_lathe, make_turned): points (radius, height), connected by lines and
/// arcs.
class Outline {
 public:
  explicit Outline(const glm::vec2& start) : points_{start} {}
  Outline& line_to(float radius, float height);
  /// Adds a curve to the point (radius, height). The curve's middle is `bulge` outside the straight line (negative:
  /// inside).
  Outline& arc_to(float radius, float height, float bulge);
  /// Adds an arc about `centre`, between two angles in turns: 0 is outwards, 0.25 up.
  Outline& add_arc(const glm::vec2& centre, float radius, double from, double to);
  const std::vector<glm::vec2>& points() const { return points_; }

 private:
  std::vector<glm::vec2> points_;
};

/// Returns the `count` points that best keep the line's shape, ends included.
std::vector<glm::vec2> simplify_line(std::vector<glm::vec2> points, std::size_t count);

/// Makes a solid of revolution that `shape(around, k, point)` may deform. `shape` returns the new position of `point`;
/// `around` is the angle in turns, `k` the index in the profile. The surface is smooth, but a repeated profile point
/// makes an edge.
Mesh make_turned(std::string name, const std::vector<glm::vec2>& profile, std::uint32_t segments,
                 const std::function<glm::vec3(float around, std::size_t k, const glm::vec3& point)>& shape);

}  // namespace traces
