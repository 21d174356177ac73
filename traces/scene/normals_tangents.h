#pragma once
#include <cstdint>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Gives every triangle its own vertices with its geometric normal, as glTF demands if a file has no normals. Returns
/// for each new vertex the old one that it copies.
std::vector<std::uint32_t> make_flat_normals(Mesh& mesh);

/// Returns for every vertex the normal of the last triangle that uses it. Intended for meshes with flat normals.
std::vector<glm::vec3> triangle_normals(const Mesh& mesh);

/// Scales normals to length 1. A zero normal becomes the geometric normal of a triangle that uses the vertex.
void repair_normals(Mesh& mesh);

/// Computes Mesh::tangents by the rule of MikkTSpace (Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008), as
/// glTF demands where a file has none:
///
///   1. Corners of equal position, normal and texture coordinate are one vertex.
///   2. Triangles around a vertex form a group if shared edges connect them and their texture coordinates have the same
///      winding. A triangle whose coordinates have no area joins a group that reaches it.
///   3. A group has one tangent: the directions of increasing u, perpendicular to the normal, weighted by the angle of
///      each triangle at the vertex.
///   4. w is +1 if the texture is not mirrored: the bitangent cross(normal, tangent) * w then points to the texture's
///      top, where v is 0.
///
/// A vertex whose triangles belong to groups with different tangents is split; the copies are appended. If coordinates
/// give no direction, the tangent is any unit vector perpendicular to the normal. Needs unit normals. `second`: use
/// Mesh::second_uvs. Returns for each vertex the old vertex that it copies.
std::vector<std::uint32_t> compute_tangents(Mesh& mesh, bool second);

/// Replaces the vertices of a mesh: new vertex i is a copy of old vertex from[i]. Triangles are unchanged.
void select_vertices(Mesh& mesh, const std::vector<std::uint32_t>& from);

}  // namespace traces
