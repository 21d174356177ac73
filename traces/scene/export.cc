#include "traces/scene/export.h"

#include "sim/io/printable.h"
#include "traces/scene/gltf_export/document.h"
#include "traces/scene/gltf_export/materials.h"
#include "traces/scene/gltf_export/nodes.h"

namespace traces {

std::string export_glb(const Scene& scene) {
  gltf_export::Document out;
  out.model.asset.version = "2.0";
  out.model.asset.generator = "Raywatt";
  out.model.defaultScene = 0;
  out.model.scenes.emplace_back().name = sim::printable(scene.name);
  gltf_export::write_textures(scene, out);
  gltf_export::write_materials(scene, out);
  gltf_export::NodeMap map = gltf_export::write_nodes(scene, out);
  gltf_export::Meshes meshes(scene, out);
  gltf_export::write_instances(scene, meshes, map, out);
  gltf_export::write_cameras(scene, map, out);
  gltf_export::write_skins(scene, map, out);
  gltf_export::write_lights(scene, map, out);
  gltf_export::write_animation(scene, map, out);
  return std::move(out).glb_bytes();
}

}  // namespace traces
