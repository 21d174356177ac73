#include "traces/scene/gltf.h"

#include <new>
#include <numbers>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/cameras.h"
#include "traces/scene/gltf/compressed.h"
#include "traces/scene/gltf/context.h"
#include "traces/scene/gltf/materials.h"
#include "traces/scene/gltf/meshes.h"
#include "traces/scene/gltf/motion.h"
#include "traces/scene/gltf/nodes.h"
#include "traces/scene/gltf/parse.h"
#include "traces/scene/gltf/schema.h"
#include "traces/scene/gltf/source.h"
#include "traces/scene/lights.h"

namespace traces::gltf {
namespace {

constexpr float kBrightest = 1e6F;

/// Reads a colour of three numbers from the scene's `raywatt` extras, each clamped to 0..kBrightest.
glm::vec3 read_colour(const Context& context, const tinygltf::Value& ours, const char* key) {
  const std::string what = std::string("extras.raywatt.") + key;
  std::vector<double> list;
  const tinygltf::Value& found = ours.Get(key);
  for (std::size_t i = 0; found.IsArray() && i < found.ArrayLen(); ++i) {
    const tinygltf::Value& number = found.Get(static_cast<int>(i));
    if (number.IsNumber()) list.push_back(number.GetNumberAsDouble());
  }
  if (list.size() != 3) context.refuse(what + " must be three numbers");
  return glm::clamp(to_vec3(context, list, glm::vec3(0), what), 0.0F, kBrightest);
}

/// Reads the background and ambient light that export_glb() stores in the scene's extras, `"raywatt": {"background":
/// [r, g, b], "ambient": [r, g, b]}`, and converts the file's lights from glTF's units. Returns false if the extras are
/// missing. If they are present, no lights for emitters, default sun or exposure are added.
bool read_light_extras(Context& context) {
  const tinygltf::Model& model = context.model;
  if (model.scenes.empty()) return false;
  const tinygltf::Value& extras =
      context.at(model.scenes, model.defaultScene < 0 ? 0 : model.defaultScene, "scenes").extras;
  if (!extras.IsObject() || !extras.Get("raywatt").IsObject()) return false;
  const tinygltf::Value& ours = extras.Get("raywatt");
  if (!ours.Has("background") || !ours.Has("ambient")) return false;
  context.scene.background = read_colour(context, ours, "background");
  context.scene.ambient = read_colour(context, ours, "ambient");
  for (Light& light : context.scene.lights) light.intensity *= std::numbers::inv_pi_v<float>;
  return true;
}

}  // namespace
}  // namespace traces::gltf

namespace traces {
namespace {

/// Poses the scene of an animated file at time 0. Errors name the file.
void pose_at_zero(gltf::Context& context) {
  try {
    pose_scene(context.scene, 0);
  } catch (const sim::InputError& error) {
    context.refuse(error.what());
  }
}

Scene read_scene(const std::filesystem::path& path, const SceneLimits& limits) {
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
      context.add_warning(fmt::format("the extension {} is not supported and left out", sim::printable(extension)));
    }
  }
  gltf::expand_meshopt(context, model);
  gltf::expand_draco(context, model);
  gltf::Textures textures(context);
  gltf::Meshes meshes(context, gltf::read_materials(context, textures));
  gltf::read_nodes(context, meshes);
  gltf::read_skins_and_morph_weights(context);
  gltf::read_animations(context);
  pose_at_zero(context);
  if (scene.instances.empty())
    context.refuse(
        "shows no triangles; at least one is needed; points, lines and primitives without POSITION do not count");
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene));
  if (!gltf::read_light_extras(context)) finish_lights(scene);
  pose_scene(scene, 0);  // includes the lights of emitters: a later pose at time 0 gives the same bits
  return scene;
}

}  // namespace

Scene load_gltf(const std::filesystem::path& path, const SceneLimits& limits) {
  try {
    return read_scene(path, limits);
  } catch (const std::bad_alloc&) {
    throw sim::InputError(sim::printable(path.string()) + ": needs more memory than this machine has left");
  }
}

}  // namespace traces
