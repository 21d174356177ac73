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

/// Computes the value of an animation track at time `seconds`, which consists of `out.size()` numbers. Rotations (four
/// numbers) have unit length; linearly interpolated ones follow the shortest arc. Only arithmetic and square roots are
/// used, so that every host gets the same bits.
void sample_track(const Track& track, double seconds, std::span<double> out);

/// Computes the derivative, per second, of a cubic spline track at time `seconds`.
void sample_track_slope(const Track& track, double seconds, std::span<double> out);

struct Scene;

/// Returns the matrix that applies scale, then rotation (a unit quaternion), then translation.
glm::dmat4 transform_matrix(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale);

/// Transforms of all of Scene::nodes at one time of the animation.
struct NodePoses {
  std::vector<glm::dmat4> to_world;
  std::vector<std::vector<double>> morph_weights;
};

/// Computes the transforms of all nodes at time `seconds` of the animation. Throws InputError if a node is farther than
/// kFarthest away.
NodePoses pose_nodes(const Scene& scene, double seconds);

double largest_entry(const glm::dmat4& m);

/// Computes positions, normals and tangents of a deforming mesh from its rest pose: morph targets, then the skin
/// (linear blend). Normals are transformed by the cofactors of the blended matrix, or recomputed from the triangles if
/// the file has none. `joints` map from bind pose to world. Returns true if anything changed.
bool deform_mesh(Mesh& mesh, std::span<const glm::dmat4x3> joints, std::span<const double> morph_weights);

}  // namespace traces
