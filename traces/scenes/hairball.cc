#include <algorithm>
#include <cmath>
#include <string>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace {

constexpr std::uint32_t kTriangles = 2'880'000;
constexpr std::uint32_t kBundles = 12, kColours = 3;
constexpr std::uint32_t kSegments = 40;  // segments of a strand
constexpr std::uint32_t kSides = 3;
constexpr std::uint32_t kLock = 14;  // number of parallel strands in a lock
constexpr float kFov = 0.62F;
constexpr glm::vec3 kMiddle{0, 1.22F, 0};

glm::vec3 any_direction(std::uint64_t a, std::uint64_t b) {
  const float y = random_between(-1, 1, a, b, 1);
  const glm::vec2 round = circle_point(static_cast<double>(random_unit(a, b, 2)));
  const float r = std::sqrt(std::max(1 - y * y, 0.0F));
  return {r * round.x, y, r * round.y};
}

/// Adds a strand of hair that winds over the unit sphere, in and out, and gets thinner.
void add_strand(Mesh& mesh, std::uint64_t bundle, std::uint64_t strand, float radius) {
  const std::uint64_t lock = strand / kLock;
  glm::vec3 way = glm::normalize(any_direction(bundle * 2, lock) + 0.13F * any_direction(bundle * 2, strand + 99));
  glm::vec3 heading = glm::normalize(glm::cross(way, any_direction(bundle * 2 + 1, lock)));
  const float depth = random_between(0.25F, 0.97F, bundle, lock, 3) + 0.05F * random_unit(bundle, strand, 9);
  const float wave = random_unit(bundle, lock, 4) + 0.12F * random_unit(bundle, strand, 4);
  const float rate = random_between(0.6F, 1.7F, bundle, lock, 5);
  const float stride = random_between(0.012F, 0.034F, bundle, lock, 6);  // turns per segment
  const float loose = random_unit(bundle, strand, 8);
  const float flown = loose > 0.93F ? 0.3F : 0.04F;  // a few strands project from the ball
  float bend = 0;
  glm::vec3 last = way * depth;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t k = 0; k <= kSegments; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(kSegments);
    const float c = cos_turns(static_cast<double>(stride)), s = sin_turns(static_cast<double>(stride));
    const glm::vec3 ahead = heading * c - way * s;
    way = glm::normalize(way * c + heading * s);
    bend = 0.8F * bend + 0.035F * (2 * random_unit(bundle * 4099 + (loose > 0.8F ? strand : lock), k, 7) - 1);
    const float bc = cos_turns(static_cast<double>(bend)), bs = sin_turns(static_cast<double>(bend));
    heading = glm::normalize(ahead * bc + glm::cross(way, ahead) * bs);
    heading = glm::normalize(heading - way * glm::dot(heading, way));
    const float out = depth + (0.05F + 0.45F * (1 - depth)) * sin_turns(static_cast<double>(wave + rate * t));
    const glm::vec3 at = way * (std::min(out, 1.0F + 0.1F * loose) + flown * t * t);
    const glm::vec3 along = k == 0 ? heading : glm::normalize(at - last + 1e-4F * heading);
    last = at;
    const glm::vec3 up = glm::normalize(way - along * glm::dot(way, along) + 1e-4F * glm::cross(way, heading));
    const glm::vec3 right = glm::cross(up, along);
    const float thick = radius * (1 - 0.75F * t);
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const glm::vec2 round = circle_point(static_cast<double>(i) / kSides);
      const glm::vec3 normal = glm::normalize(right * round.x - up * round.y);
      mesh.positions.push_back(at + thick * normal);
      mesh.normals.push_back(normal);
    }
    if (k == 0) continue;
    const std::uint32_t ring = first + (k - 1) * kSides;
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t a = ring + i, b = ring + (i + 1) % kSides;
      mesh.triangles.push_back({a, b + kSides, b});
      mesh.triangles.push_back({a, a + kSides, b + kSides});
    }
  }
}

void add_room(Scene& scene) {
  scene.textures.push_back(
      tile_texture("floor tiles", {0.55F, 0.56F, 0.60F}, {0.38F, 0.39F, 0.44F}, {0.20F, 0.20F, 0.22F}, 8, 3));
  scene.textures.push_back(stone_texture("plaster", {0.72F, 0.74F, 0.78F}, {0.52F, 0.54F, 0.60F}, 5));
  const std::uint32_t floor = add_material(scene, make_textured("mirror floor", 0, glm::vec3(1), 0.62F));
  const std::uint32_t wall = add_material(scene, make_textured("back wall", 1, {0.34F, 0.38F, 0.47F}));
  const std::uint32_t mirror = add_material(scene, make_metal("mirror", {0.94F, 0.96F, 0.98F}, 0.88F));
  const std::uint32_t brass = add_material(scene, make_metal("brass", {0.90F, 0.70F, 0.38F}, 0.6F));
  add_object(scene, make_quad("floor", {-6, 0, -2.6F}, {0, 0, 9.6F}, {8, 0, 0}, 8, 4), floor);
  add_object(scene, make_quad("back wall", {-6, 0, -2.6F}, {8, 0, 0}, {0, 4.4F, 0}, 8, 2), wall);
  add_object(scene, make_quad("right wall", {2, 0, -2.6F}, {0, 0, 9.6F}, {0, 4.4F, 0}, 8), mirror);
  add_object(scene, transform_mesh(make_torus("stand", 0.42F, 0.045F, 64, 16), placement_at({0, 0.28F, 0})), brass);
  for (int k = 0; k < 3; ++k) {
    const glm::vec2 round = circle_point(k / 3.0 + 0.1);
    const glm::vec3 leg[] = {{0.62F * round.x, 0.02F, 0.62F * round.y}, {0.42F * round.x, 0.28F, 0.42F * round.y}};
    const float radius[] = {0.03F};
    add_object(scene, make_tube("leg", leg, radius, 12), brass);
  }
}

void add_lights(Scene& scene) {
  struct Lamp {
    glm::vec3 position, intensity;
  };
  constexpr Lamp kLamps[] = {{{-2.2F, 3.2F, 3.4F}, {14, 13, 11.6F}},
                             {{1.1F, 3.4F, 3.6F}, {5.5F, 6.2F, 7.5F}},
                             {{-2.6F, 4.0F, -0.6F}, {6, 4.6F, 3.2F}}};
  for (const Lamp& lamp : kLamps) {
    Light light;
    light.position = lamp.position;
    light.intensity = lamp.intensity;
    scene.lights.push_back(light);
  }
}

}  // namespace

/// Builds a ball of hair: twelve bundles of strands in three colours, each bundle rotated differently.
Scene build_hairball(const BuiltinOptions& options) {
  const std::uint32_t triangles = options.triangles_or_default(kTriangles);
  Scene scene;
  scene.name = "hairball";
  scene.background = {0.10F, 0.12F, 0.16F};
  add_room(scene);
  constexpr std::uint32_t kStrand = 2 * kSides * kSegments;
  const auto room = static_cast<std::uint32_t>(count_triangles(scene));
  const std::uint32_t strands =
      std::max((std::max(triangles, room) - room + kBundles * kStrand / 2) / (kBundles * kStrand), 8U);
  // With fewer strands each is thicker, so that the ball remains equally dense.
  const float radius = 0.0055F * std::sqrt(std::clamp(1000 / static_cast<float>(strands), 0.3F, 16.0F));
  const glm::vec3 colours[kColours] = {{0.86F, 0.38F, 0.14F}, {0.95F, 0.70F, 0.34F}, {0.50F, 0.22F, 0.12F}};
  for (std::uint32_t colour = 0; colour < kColours; ++colour) {
    const std::string name = "strands " + std::to_string(colour + 1);
    const std::uint32_t material = add_material(scene, make_paint(name, colours[colour], 0.12F));
    Mesh bundle;
    bundle.name = name;
    bundle.positions.reserve(std::size_t{strands} * (kSegments + 1) * kSides);
    bundle.normals.reserve(std::size_t{strands} * (kSegments + 1) * kSides);
    bundle.triangles.reserve(std::size_t{strands} * kStrand);
    for (std::uint32_t k = 0; k < strands; ++k) add_strand(bundle, colour + 11, k, radius);
    const std::uint32_t mesh = add_mesh(scene, std::move(bundle), material);
    for (std::uint32_t k = 0; k < kBundles / kColours; ++k) {
      const glm::quat turn =
          axis_rotation(any_direction(colour, k + 50), static_cast<double>(random_unit(colour, k + 60)));
      glm::mat4 at = glm::mat4_cast(turn);
      at[3] = glm::vec4(kMiddle, 1);
      add_instance(scene, mesh, at);
    }
  }
  add_lights(scene);
  scene.cameras.push_back(look_at("front", {-1.9F, 1.75F, 4.9F}, {0.42F, 1.0F, -0.1F}, kFov));
  scene.cameras.push_back(look_at("close", {-0.7F, 1.6F, 1.9F}, {0.05F, 1.2F, 0}, kFov));
  const ViewKey keys[] = {
      {0, {-1.9F, 1.75F, 4.9F}, {0.42F, 1.0F, -0.1F}}, {2.5F, {-0.4F, 1.5F, 3.8F}, {0.3F, 1.1F, 0}},
      {5, {0.9F, 1.3F, 2.1F}, {0.0F, 1.2F, 0}},        {7.5F, {-0.7F, 1.7F, 1.8F}, {0.1F, 1.2F, 0}},
      {10, {-2.6F, 2.1F, 1.2F}, {0.4F, 1.1F, 0}},      {12, {-3.9F, 1.6F, 2.8F}, {0.7F, 1.05F, -0.2F}}};
  add_camera_path(scene, "path", keys, kFov);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
