#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/car/body.h"
#include "traces/scenes/car/hall.h"
#include "traces/scenes/car/trim.h"
#include "traces/scenes/car/wheel.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/modelling/turned.h"

namespace traces {
namespace {

constexpr float kSeconds = 6, kWay = 7;

/// Returns the distance driven at a time; the car starts and ends at rest.
float driven(float seconds) {
  const float t = seconds / kSeconds;
  return kWay * t * t * t * (10 - 15 * t + 6 * t * t);
}

/// Attaches a mesh to a node and shows it at the node's rest position.
void add_part(Scene& scene, Mesh mesh, std::uint32_t material, std::uint32_t node) {
  hang(scene, add_instance(scene, add_mesh(scene, std::move(mesh), material)), node);
}

void add_wheels(Scene& scene, std::uint32_t body, const Detail& detail) {
  const std::uint32_t rubber = add_material(scene, paint("rubber", {0.035F, 0.035F, 0.038F}));
  const std::uint32_t alloy = add_material(scene, metal("alloy", {0.86F, 0.87F, 0.90F}, 0.45F));
  const std::uint32_t steel = add_material(scene, metal("steel", {0.42F, 0.42F, 0.44F}, 0.35F));
  const std::uint32_t red = add_material(scene, paint("caliper", {0.75F, 0.62F, 0.04F}, 0.1F));
  const std::uint32_t tyre = add_mesh(scene, car::make_tyre(detail), rubber);
  const std::uint32_t rim = add_mesh(scene, car::make_rim(detail), alloy);
  const std::uint32_t disc = add_mesh(scene, car::make_brake_disc(detail), steel);
  const std::uint32_t caliper = add_mesh(scene, car::make_caliper(detail), red);
  constexpr int kKeys = 96;
  for (const float x : {car::kFrontAxle, car::kRearAxle}) {
    for (const float side : {-1.0F, 1.0F}) {
      const glm::vec3 centre(x, car::kWheel, side * car::kTrack);
      const glm::quat out = rotation({0, 1, 0}, side > 0 ? 0 : 0.5);
      const std::uint32_t hub = add_node(scene, "hub", {.translation = centre}, body);
      const std::uint32_t still = add_node(scene, "brake", {.rotation = out}, hub);
      const std::uint32_t axle = add_node(scene, "axle", {}, hub);
      std::vector<TurnKey> turns;
      for (int k = 0; k <= kKeys; ++k) {
        const float seconds = kSeconds * static_cast<float>(k) / kKeys;
        constexpr float kRound = 6.2831853F * car::kWheel;
        turns.push_back({seconds, rotation({0, 0, 1}, -static_cast<double>(driven(seconds) / kRound))});
      }
      turn_node(scene, axle, turns);
      const std::uint32_t wheel = add_node(scene, "wheel", {.rotation = out}, axle);
      for (const std::uint32_t mesh : {tyre, rim, disc}) hang(scene, add_instance(scene, mesh), wheel);
      hang(scene, add_instance(scene, caliper), still);
    }
  }
}

std::uint64_t triangles_of_car(const Detail& detail) {
  std::uint64_t sum = 0;
  for (const Mesh& mesh :
       {car::make_shell(detail), car::make_cabin(detail), car::make_underbody(detail), car::make_arch_lips(detail)}) {
    sum += mesh.triangles.size();
  }
  for (const Mesh& mesh :
       {car::make_tyre(detail), car::make_rim(detail), car::make_brake_disc(detail), car::make_caliper(detail)}) {
    sum += 4 * mesh.triangles.size();
  }
  return sum;
}

}  // namespace

/// A coupe that drives through a hall: one large glossy object of smooth curves.
Scene build_car(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 55'000;
  Scene scene;
  scene.name = "car";
  scene.background = glm::vec3(0.05F);
  const std::uint64_t wanted = options.triangles_or(kClass);
  const Detail rough = detail_for(static_cast<double>(wanted), kClass);
  car::add_hall(scene, rough);
  const Detail detail =
      fit_detail(wanted, triangles_of_car, {.made = triangles_of(scene) + car::triangles_of_trim(rough)});

  const std::uint32_t node = add_node(scene, "car", {.translation = {-0.4F, 0, 0}});
  std::vector<Key> keys;
  for (int k = 0; k <= 48; ++k) {
    const float seconds = kSeconds * static_cast<float>(k) / 48;
    keys.push_back({seconds, {-0.4F + driven(seconds), 0, 0}});
  }
  move_node(scene, node, keys);
  const std::uint32_t lacquer = add_material(scene, paint("red lacquer", {0.62F, 0.025F, 0.02F}, 0.20F));
  const std::uint32_t black = add_material(scene, paint("underbody", {0.012F, 0.012F, 0.013F}));
  const Mesh shell = car::make_shell(detail), cabin = car::make_cabin(detail);
  car::add_trim(scene, shell, cabin, node, lacquer, rough);
  add_part(scene, shell, lacquer, node);
  add_part(scene, cabin, lacquer, node);
  add_part(scene, car::make_arch_lips(detail), lacquer, node);
  add_part(scene, car::make_underbody(detail), black, node);
  add_wheels(scene, node, detail);

  scene.cameras.push_back(look_at("front", {4.6F, 1.7F, 4.5F}, {-0.2F, 0.50F, 0.05F}, 0.44F));
  scene.cameras.push_back(look_at("rear", {-5.2F, 1.7F, 3.9F}, {-0.4F, 0.55F, 0}, 0.5F));
  const ViewKey path[] = {{0, {4.4F, 0.9F, 4.2F}, {-0.2F, 0.55F, 0}},
                          {1.5F, {4.2F, 1.0F, 4.6F}, {0.6F, 0.55F, 0}},
                          {3, {3.4F, 1.3F, 5.0F}, {3.0F, 0.55F, 0}},
                          {4.5F, {2.4F, 1.6F, 4.8F}, {5.6F, 0.5F, 0}},
                          {6, {2.2F, 1.9F, 4.4F}, {6.4F, 0.5F, 0}}};
  add_camera_path(scene, "path", path, 0.6F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
