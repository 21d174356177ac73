#pragma once
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace traces {

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

}  // namespace traces
