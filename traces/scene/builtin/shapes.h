#pragma once
#include <string>

#include "traces/scene/scene.h"

namespace traces {

// Shapes are made with +, *, / and square roots alone, which every compiler and library rounds alike.

/// Parallelogram `corner`, `corner + u`, `corner + v`, cut into cells x cells squares; normal along u x v; texture
/// coordinates run from 0 to `repeats`.
Mesh make_quad(std::string name, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, std::uint32_t cells,
               float repeats = 1);

/// A cube of six cells x cells faces blown up to a sphere, normals outwards.
Mesh make_sphere(std::string name, const glm::vec3& centre, float radius, std::uint32_t cells);

/// Adds two triangles for each cell of a (columns + 1) x (rows + 1) grid of vertices that starts at vertex `first`.
void add_grid(Mesh& mesh, std::uint32_t first, std::uint32_t columns, std::uint32_t rows);

/// Adds the mesh with its material and one instance where it stands.
void add_object(Scene& scene, Mesh mesh, std::uint32_t material);

std::uint32_t add_material(Scene& scene, Material material);

/// SHA-256 of everything in the scene that can change a picture.
std::string scene_digest(const Scene& scene);

}  // namespace traces
