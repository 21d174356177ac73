#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <tiny_gltf.h>

#include "traces/scene/animation.h"
#include "traces/scene/gltf_export/document.h"

namespace traces::gltf_export {

/// A transform that applies scale, then rotation, then translation.
struct Placement {
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
};

/// True if the matrix consists of a translation, a rotation and a scale, as glTF demands of a node.
bool is_placement(const glm::mat4& matrix);

/// An affine matrix as the product of an outer placement and an inner one, which only rotates. A matrix that shears, as
/// nodes of uneven scale make, is a rotation, a scale and another rotation (singular value decomposition).
struct TwoPlacements {
  Placement outer, inner;
};
TwoPlacements split_matrix(const glm::mat4& matrix);

/// Set the transform of a glTF node. Values equal to glTF's defaults are not written.
void set_transform(tinygltf::Node& node, const Placement& placement);
void set_transform(tinygltf::Node& node, const Transform& transform);
void set_transform(tinygltf::Node& node, const glm::mat4& matrix);

/// Writes the scene's meshes. A mesh is written when it is first used; later uses share its accessors.
class Meshes {
 public:
  Meshes(const Scene& scene, Document& out) : scene_(scene), out_(out) {}

  /// Returns the index of a glTF mesh whose primitives are the meshes `parts` of Scene::meshes.
  int gltf_mesh_of(const std::vector<std::uint32_t>& parts);

 private:
  const tinygltf::Primitive& primitive_of(std::uint32_t mesh);
  tinygltf::Primitive write_primitive(const Mesh& mesh);

  const Scene& scene_;
  Document& out_;
  std::map<std::uint32_t, tinygltf::Primitive> primitives_;
  std::map<std::vector<std::uint32_t>, int> meshes_;
};

/// Appends a node below `parent`, or to the roots of the scene if that is -1. Returns its index.
int add_node(Document& out, int parent, tinygltf::Node node);

/// Appends one node with the transform `matrix`, or two if it shears. Returns the index of the inner node.
int add_placed(Document& out, int parent, const glm::mat4& matrix);

/// The glTF indices of the scene's nodes and skins.
struct NodeMap {
  std::vector<int> gltf_nodes;             ///< for each of Scene::nodes, its glTF node
  std::vector<std::vector<int>> morphing;  ///< for each of Scene::nodes, the glTF nodes that show its morphing meshes
  std::vector<std::uint32_t> skins;  ///< indices in Scene::skins of the skins in use, in the order of the glTF skins
};

/// Writes Scene::nodes. A node with both a matrix and a transform, or with a matrix that glTF does not allow, becomes a
/// chain of nodes. The returned map refers to the innermost node.
NodeMap write_nodes(const Scene& scene, Document& out);

/// Writes Scene::instances. Instances of one node become primitives of one glTF mesh. Skinned meshes get root nodes of
/// their own, because only their joints place them.
void write_instances(const Scene& scene, Meshes& meshes, NodeMap& map, Document& out);

/// Writes the skins that instances use. glTF demands distinct joints with a common root: a repeated joint is replaced
/// by a new child of its node, and if the joints have several roots, a new root is added above these.
void write_skins(const Scene& scene, const NodeMap& map, Document& out);

/// Writes Scene::cameras, and sorts the root nodes so that readers find the cameras in the same order where possible.
void write_cameras(const Scene& scene, const NodeMap& map, Document& out);

/// Writes one animation with all tracks that have an effect. Tracks with equal key times share one array of times.
void write_animation(const Scene& scene, const NodeMap& map, Document& out);

/// Writes Scene::lights with KHR_lights_punctual. Background and ambient light, which glTF cannot express, are written
/// to the scene's extras: `"raywatt": {"background": [r, g, b], "ambient": [r, g, b]}`.
///
/// Intensities are multiplied by pi: a white surface has radiance 1 at an irradiance of pi in glTF, and of 1 in a Scene
/// (traces/scene/scene.h). If a file has the extras, the loader adds no lights for emitters and does not change the
/// exposure (traces/scene/gltf.cc).
void write_lights(const Scene& scene, const NodeMap& map, Document& out);

}  // namespace traces::gltf_export
