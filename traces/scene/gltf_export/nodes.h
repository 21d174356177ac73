#pragma once
#include <cstdint>
#include <vector>

#include "traces/scene/gltf_export/document.h"
#include "traces/scene/gltf_export/meshes.h"

namespace traces::gltf_export {

/// Appends a node below `parent`, or below the scene if that is -1; returns its index.
int add_node(Document& out, int parent, tinygltf::Node node);

/// Appends what has this transform: one node, or two where it shears. Returns the inner one.
int add_placed(Document& out, int parent, const glm::mat4& matrix);

/// Where the scene's nodes went.
struct NodeMap {
  std::vector<int> gltf_nodes;             ///< glTF node of each of Scene::nodes
  std::vector<std::vector<int>> morphing;  ///< glTF nodes that show the morphing meshes of each of Scene::nodes
  std::vector<std::uint32_t> skins;        ///< those of Scene::skins that are shown, in the order of the glTF skins
};

/// Writes Scene::nodes. A node that has both a matrix and a transform, or a matrix that glTF does not allow, becomes a
/// chain of nodes, of which the innermost counts.
NodeMap write_nodes(const Scene& scene, Document& out);

/// Writes Scene::instances: those of one node are primitives of one glTF mesh. Skinned meshes hang on nodes of their
/// own below the scene, as their joints alone say where they are.
void write_instances(const Scene& scene, Meshes& meshes, NodeMap& map, Document& out);

/// Writes the skins that instances show. glTF demands that a skin's joints differ and have a common root: a joint that
/// is repeated becomes a child of itself, and joints of several roots get a root above all others.
void write_skins(const Scene& scene, const NodeMap& map, Document& out);

/// Writes Scene::cameras. Readers meet them in this order as far as the nodes allow.
void write_cameras(const Scene& scene, const NodeMap& map, Document& out);

/// Writes the tracks that count as one animation; those of equal key times share them.
void write_animation(const Scene& scene, const NodeMap& map, Document& out);

}  // namespace traces::gltf_export
