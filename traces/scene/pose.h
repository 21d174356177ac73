#pragma once
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "traces/scene/animation.h"
#include "traces/scene/scene.h"

namespace traces {

/// Computes the track's value at a time, `out.size()` numbers. Rotations (four numbers) have unit length; linear ones
/// follow the shortest arc. Arithmetic and square roots only, so that every host gets the same bits.
void sample_track(const Track& track, double seconds, std::span<double> out);

/// Computes in `out` the time derivative, per second, of a cubic spline track.
void sample_track_slope(const Track& track, double seconds, std::span<double> out);

struct Scene;

/// Returns the matrix that applies scale, rotation (unit) and translation in this order.
glm::dmat4 matrix_of(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale);

/// Scene::nodes at a time.
struct NodePoses {
  std::vector<glm::dmat4> to_world;
  std::vector<std::vector<double>> morph_weights;
};

/// Computes all nodes at a time. Throws InputError if a node is further than kFarthest from the origin.
NodePoses pose_nodes(const Scene& scene, double seconds);

double largest_entry(const glm::dmat4& m);

/// Computes positions, normals and tangents of a deforming mesh from its rest pose: morph targets, then the skin
/// (linear blend). Normals are transformed by the cofactors of the blended matrix, or recomputed from the triangles if
/// the file has none. `joints` map from bind pose to world. Returns true if anything changed.
bool deform_mesh(Mesh& mesh, std::span<const glm::dmat4x3> joints, std::span<const double> morph_weights);

}  // namespace traces
