#include "traces/scene/gltf.h"

#include <new>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/cameras.h"
#include "traces/scene/gltf/compressed/draco.h"
#include "traces/scene/gltf/compressed/meshopt.h"
#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/extensions.h"
#include "traces/scene/gltf/final_light.h"
#include "traces/scene/gltf/materials/textures.h"
#include "traces/scene/gltf/meshes.h"
#include "traces/scene/gltf/nodes/animations.h"
#include "traces/scene/gltf/nodes/nodes.h"
#include "traces/scene/gltf/nodes/skins.h"
#include "traces/scene/gltf/parse.h"
#include "traces/scene/gltf/source.h"
#include "traces/scene/lights.h"

namespace traces {
namespace {

/// Poses an animated file at time 0.
void place_all(gltf::Context& context) {
  try {
    pose(context.scene, 0);
  } catch (const sim::InputError& error) {
    context.refuse(error.what());
  }
}

Scene read(const std::filesystem::path& path, const SceneLimits& limits) {
  gltf::Budget budget(sim::printable(path.string()), limits.memory.bytes);
  Scene scene;
  scene.name = path.stem().string();
  gltf::Source source = gltf::read_source(path, limits, budget);
  tinygltf::Model model = gltf::parse_model(source);
  scene.sha256 = source.sha256;
  const std::string file = source.shown_name;
  source = {};

  gltf::Context context{file, model, limits, budget, scene};
  for (const std::string& extension : model.extensionsUsed) {
    if (!gltf::is_supported_extension(extension)) {
      context.warn(fmt::format("the extension {} is not supported and left out", sim::printable(extension)));
    }
  }
  gltf::expand_meshopt(context, model);
  gltf::expand_draco(context, model);
  gltf::Textures textures(context);
  gltf::Meshes meshes(context, gltf::read_materials(context, textures));
  gltf::read_nodes(context, meshes);
  gltf::finish_deformations(context);
  gltf::read_animations(context);
  place_all(context);
  if (scene.instances.empty())
    context.refuse(
        "shows no triangles; at least one is needed; points, lines and primitives without POSITION do not count");
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene));
  if (!gltf::read_final_light(context)) finish_lights(scene);
  pose(scene, 0);  // before emitters are replaced by lights, so that a later pose at time 0 gives the same bits
  return scene;
}

}  // namespace

Scene load_gltf(const std::filesystem::path& path, const SceneLimits& limits) {
  try {
    return read(path, limits);
  } catch (const std::bad_alloc&) {
    throw sim::InputError(sim::printable(path.string()) + ": needs more memory than this machine has left");
  }
}

}  // namespace traces
