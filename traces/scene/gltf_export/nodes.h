#pragma once
#include <cstdint>
#include <vector>

#include "traces/scene/gltf_export/document.h"
#include "traces/scene/gltf_export/meshes.h"

namespace traces::gltf_export {

/// Appends a node below `parent`, or below the scene if that is -1; returns its index.
int add_node(Document& out, int parent, tinygltf::Node node);

/// Appends one node with this transform, or two if it shears; returns the inner one's index.
int add_placed(Document& out, int parent, const glm::mat4& matrix);

/// glTF indices of the scene's nodes and skins.
struct NodeMap {
  std::vector<int> gltf_nodes;             ///< glTF node of each of Scene::nodes
  std::vector<std::vector<int>> morphing;  ///< glTF nodes that show the morphing meshes of each of Scene::nodes
  std::vector<std::uint32_t> skins;  ///< indices in Scene::skins of the shown ones, in the order of the glTF skins
};

/// Writes Scene::nodes. A node with both a matrix and a transform, or with a matrix that glTF does not allow, becomes a
/// chain of nodes; the map refers to the innermost.
NodeMap write_nodes(const Scene& scene, Document& out);

/// Writes Scene::instances; instances of one node become primitives of one glTF mesh. Skinned meshes get root nodes of
/// their own, as their joints alone place them.
void write_instances(const Scene& scene, Meshes& meshes, NodeMap& map, Document& out);

/// Writes the skins that instances show. glTF demands distinct joints with a common root: a repeated joint becomes a
/// child of itself, and joints of several roots get a root above all.
void write_skins(const Scene& scene, const NodeMap& map, Document& out);

/// Writes Scene::cameras, in this order as far as the node tree allows.
void write_cameras(const Scene& scene, const NodeMap& map, Document& out);

/// Writes the tracks that take effect as one animation; tracks with equal key times share them.
void write_animation(const Scene& scene, const NodeMap& map, Document& out);

}  // namespace traces::gltf_export
