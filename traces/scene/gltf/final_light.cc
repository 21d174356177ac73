#include "traces/scene/gltf/final_light.h"

#include <numbers>

#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

constexpr float kBrightest = 1e6F;

/// Reads three numbers, clamped to 0..kBrightest.
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

}  // namespace

bool read_final_light(Context& context) {
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

}  // namespace traces::gltf
