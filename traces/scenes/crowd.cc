#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "traces/scene/cameras.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::crowd {
namespace {

constexpr std::uint32_t kLanes = 10, kFiguresPerLane = 20;  ///< neighbouring lanes walk in opposite directions
constexpr float kLaneWidth = 1.3F, kSpacing = 1.9F;         ///< metres
constexpr std::uint32_t kSeconds = 4;                       ///< duration of the walk
constexpr float kSpeed = 1.35F;                             ///< metres per second
constexpr float kDistance = kSpeed * kSeconds;
constexpr std::uint32_t kKeysPerStride = 12;  ///< a stride of both legs takes one second
constexpr float kFloorX = 26, kFloorZ = 14;   ///< half the sides of the square

enum Joint : std::uint32_t { kHips, kChest, kHead, kLegs, kArms = kLegs + 4, kJoints = kArms + 4 };

/// A joint of the skeleton: its parent, and its position in the space of a standing figure that faces +z.
struct JointPlace {
  std::uint32_t parent;
  glm::vec3 at;
};
// The leg or arm on side -x is followed by that on side +x: thigh, shin, thigh, shin; upper arm, forearm, twice.
constexpr JointPlace kSkeleton[kJoints] = {
    {kNone, {0, 0.95F, 0}},         {kHips, {0, 1.10F, 0}},         {kChest, {0, 1.50F, 0}},
    {kHips, {-0.10F, 0.92F, 0}},    {kLegs, {-0.11F, 0.50F, 0}},    {kHips, {0.10F, 0.92F, 0}},
    {kLegs + 2, {0.11F, 0.50F, 0}}, {kChest, {-0.22F, 1.42F, 0}},   {kArms, {-0.25F, 1.14F, 0}},
    {kChest, {0.22F, 1.42F, 0}},    {kArms + 2, {0.25F, 1.14F, 0}},
};

/// The rest pose of a figure: a mesh with joints and weights per vertex.
struct Figure {
  Mesh mesh;
  Deformation rest;
};

/// Adds a part whose vertices follow joint `lower` below `height`, joint `upper` above, and both within 6 cm of it.
void add_part(Figure& figure, const Mesh& part, Joint lower, Joint upper, float height) {
  constexpr float kBlend = 0.06F;
  append_mesh(figure.mesh, part);
  for (const glm::vec3& p : part.positions) {
    const float share = std::clamp((p.y - height) / (2 * kBlend) + 0.5F, 0.0F, 1.0F);
    figure.rest.joints.push_back({static_cast<std::uint16_t>(lower), static_cast<std::uint16_t>(upper), 0, 0});
    figure.rest.weights.emplace_back(1 - share, share, 0, 0);
  }
}

/// Makes a limb: a tube from an upper joint over a lower joint to its end.
Mesh make_limb(const glm::vec3& from, const glm::vec3& over, const glm::vec3& to, const std::array<float, 3>& radii,
               std::uint32_t sides, std::uint32_t steps) {
  std::vector<glm::vec3> path;
  std::vector<float> widths;
  for (std::uint32_t i = 0; i <= 2 * steps; ++i) {
    const float t = static_cast<float>(i % steps) / static_cast<float>(steps);
    const bool is_below = i >= steps;
    path.push_back(i == 2 * steps ? to : is_below ? glm::mix(over, to, t) : glm::mix(from, over, t));
    const std::size_t k = is_below ? 1 : 0;
    widths.push_back(i == 2 * steps ? radii[2] : radii[k] + t * (radii[k + 1] - radii[k]));
  }
  return make_tube("", path, widths, sides);
}

Figure make_figure(const Detail& detail) {
  Figure figure;
  figure.mesh.name = "figure";
  const std::uint32_t sides = detail.cell_count(8, 3), steps = detail.cell_count(3);
  const glm::vec2 outline[] = {{0, 0.86F},     {0.15F, 0.90F}, {0.165F, 1.0F}, {0.14F, 1.12F},
                               {0.19F, 1.38F}, {0.15F, 1.47F}, {0.06F, 1.50F}, {0.055F, 1.56F}};
  const Mesh torso = make_turned("", detail.coarser_profile(outline), detail.cell_count(12, 4),
                                 [](float, std::size_t, const glm::vec3& p) { return p * glm::vec3(1, 1, 0.62F); });
  add_part(figure, torso, kHips, kChest, 1.10F);
  add_part(figure, make_sphere("", {0, 1.64F, 0.01F}, 0.115F, detail.cell_count(4, 1)), kChest, kHead, 1.50F);
  for (const std::uint32_t side : {0U, 2U}) {
    const auto leg = static_cast<Joint>(kLegs + side), shin = static_cast<Joint>(leg + 1);
    const glm::vec3 ankle = kSkeleton[shin].at - glm::vec3(0, 0.42F, 0);
    add_part(figure, make_limb(kSkeleton[leg].at, kSkeleton[shin].at, ankle, {0.085F, 0.06F, 0.045F}, sides, steps),
             shin, leg, kSkeleton[shin].at.y);
    const Mesh foot = make_rounded_box("", ankle + glm::vec3(-0.045F, -0.08F, -0.06F),
                                       ankle + glm::vec3(0.045F, 0.01F, 0.19F), 0.03F, 1);
    add_part(figure, foot, shin, leg, kSkeleton[shin].at.y);
    const auto arm = static_cast<Joint>(kArms + side), forearm = static_cast<Joint>(arm + 1);
    const glm::vec3 hand = kSkeleton[forearm].at + glm::vec3(0, -0.30F, 0.02F);
    add_part(figure, make_limb(kSkeleton[arm].at, kSkeleton[forearm].at, hand, {0.06F, 0.042F, 0.038F}, sides, steps),
             forearm, arm, kSkeleton[forearm].at.y);
  }
  figure.rest.positions = figure.mesh.positions;
  figure.rest.normals = figure.mesh.normals;
  return figure;
}

/// Returns the angle of a joint's rotation about the lateral axis, in turns, at phase `p` of the stride. Positive
/// swings forward.
double angle_of(std::uint32_t joint, double p) {
  const auto swing = [&](double offset) { return static_cast<double>(sin_turns(p + offset)); };
  switch (joint) {
    case kLegs:
      return 0.075 * swing(0);
    case kLegs + 1:
      return -0.015 - 0.10 * std::max(0.0, swing(0.17));
    case kLegs + 2:
      return 0.075 * swing(0.5);
    case kLegs + 3:
      return -0.015 - 0.10 * std::max(0.0, swing(0.67));
    case kArms:
      return 0.06 * swing(0.5);
    case kArms + 2:
      return 0.06 * swing(0);
    case kArms + 1:
    case kArms + 3:
      return 0.06;
    default:
      return 0;
  }
}

/// Adds the skeleton of a figure that walks from `from` for kSeconds, and returns its skin.
std::uint32_t add_walk(Scene& scene, const glm::vec3& from, float direction, double phase) {
  const glm::quat facing = axis_rotation({0, 1, 0}, direction > 0 ? 0.25 : 0.75);
  const std::uint32_t root = add_node(scene, "figure", {.translation = from, .rotation = facing});
  add_translation_track(scene, root,
                        std::array{Key{0, from}, Key{kSeconds, from + glm::vec3(direction * kDistance, 0, 0)}});
  Skin skin;
  for (std::uint32_t j = 0; j < kJoints; ++j) {
    const JointPlace& joint = kSkeleton[j];
    const glm::vec3 parent_at = joint.parent == kNone ? glm::vec3(0) : kSkeleton[joint.parent].at;
    const std::uint32_t parent = joint.parent == kNone ? root : skin.joints[joint.parent];
    skin.joints.push_back(add_node(scene, "joint", {.translation = joint.at - parent_at}, parent));
    skin.inverse_bind.push_back(glm::translate(glm::mat4(1), -joint.at));
    if (j < kLegs) continue;
    std::vector<TurnKey> keys;
    for (std::uint32_t k = 0; k <= kSeconds * kKeysPerStride; ++k) {
      const double seconds = static_cast<double>(k) / kKeysPerStride;
      keys.push_back({static_cast<float>(seconds), axis_rotation({-1, 0, 0}, angle_of(j, phase + seconds))});
    }
    add_rotation_track(scene, skin.joints.back(), keys);
  }
  scene.skins.push_back(std::move(skin));
  return static_cast<std::uint32_t>(scene.skins.size()) - 1;
}

void add_figures(Scene& scene, const Figure& figure, std::uint32_t first_material, std::uint32_t materials) {
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const float direction = lane % 2 == 0 ? 1.0F : -1.0F;
    for (std::uint32_t i = 0; i < kFiguresPerLane; ++i) {
      const auto random = [&](std::uint64_t what) { return random_unit(what, lane, i); };
      const float x = (static_cast<float>(i) - 0.5F * (kFiguresPerLane - 1) + 0.5F * random(1)) * kSpacing;
      const float z = (static_cast<float>(lane) - 0.5F * (kLanes - 1) + 0.3F * (random(2) - 0.5F)) * kLaneWidth;
      Mesh mesh = figure.mesh;
      Deformation rest = figure.rest;
      rest.skin = add_walk(scene, {x - direction * 0.5F * kDistance, 0, z}, direction, static_cast<double>(random(3)));
      mesh.deformation = std::make_shared<const Deformation>(std::move(rest));
      const auto material = static_cast<std::uint32_t>(random(4) * static_cast<float>(materials));
      add_instance(scene, add_mesh(scene, std::move(mesh), first_material + std::min(material, materials - 1)));
    }
  }
}

/// Returns a texture of paving stones.
Texture paving_texture() {
  return paint_texture("paving", 512, 512, [](float u, float v) {
    const float row = v * 8, column = u * 8 + (static_cast<int>(row) % 2 == 0 ? 0.0F : 0.5F);
    const float x = column - static_cast<float>(static_cast<int>(column)),
                y = row - static_cast<float>(static_cast<int>(row));
    const float edge = std::min(std::min(x, 1 - x), std::min(y, 1 - y));
    const float stone = random_unit(7, static_cast<std::uint64_t>(column) % 8, static_cast<std::uint64_t>(row));
    float shade = 0.5F + 0.14F * stone + 0.12F * (fractal_noise(u, v, 16, 4, 11) - 0.5F);
    if (edge < 0.03F) shade *= 0.55F;
    return glm::vec4(shade, shade * 0.97F, shade * 0.92F, 1);
  });
}

Scene make_crowd(const Detail& detail) {
  Scene scene;
  scene.name = "crowd";
  scene.background = {0.52F, 0.68F, 0.90F};
  const std::uint32_t floor = add_material(scene, make_paint("paving", glm::vec3(1)));
  const std::uint32_t wall = add_material(scene, make_paint("wall", {0.72F, 0.62F, 0.50F}));
  add_object(
      scene,
      make_quad("floor", {-kFloorX, 0, -kFloorZ}, {0, 0, 2 * kFloorZ}, {2 * kFloorX, 0, 0}, detail.cell_count(8), 6),
      floor);
  for (int k = 0; k < 9; ++k) {
    const float x = (static_cast<float>(k) - 4) * 5.6F,
                height = 7 + 5 * random_unit(5, static_cast<std::uint64_t>(k), 0);
    add_object(scene, make_box("house", {x - 2.7F, 0, -kFloorZ}, {x + 2.7F, height, -kFloorZ + 3}), wall);
  }
  const glm::vec3 colours[] = {{0.75F, 0.16F, 0.13F}, {0.13F, 0.28F, 0.62F}, {0.82F, 0.66F, 0.20F},
                               {0.18F, 0.45F, 0.24F}, {0.80F, 0.78F, 0.74F}, {0.20F, 0.20F, 0.24F}};
  const auto first = static_cast<std::uint32_t>(scene.materials.size());
  for (const glm::vec3& colour : colours) add_material(scene, make_paint("cloth", colour));
  add_figures(scene, make_figure(detail), first, std::size(colours));
  return scene;
}

}  // namespace
}  // namespace traces::crowd

namespace traces {

/// Builds a square on which 200 skinned figures walk, each with its own skeleton and mesh.
Scene build_crowd(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 200'000;
  Scene scene = build_to_size(options.triangles_or_default(kClass), crowd::make_crowd);
  scene.materials[0].base_texture.texture = add_texture(scene, crowd::paving_texture());
  scene.cameras.push_back(look_at("square", {-9.5F, 3.4F, 10.5F}, {1.5F, 0.9F, -1.5F}, 0.75F));
  const ViewKey keys[] = {{0, {-9.5F, 3.4F, 10.5F}, {1.5F, 0.9F, -1.5F}},
                          {2, {-4, 2.4F, 10.0F}, {2.5F, 1.0F, -1.5F}},
                          {4, {2, 1.9F, 9.0F}, {3.5F, 1.1F, -2.0F}}};
  add_camera_path(scene, "path", keys, 0.75F);
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(0.55F, -1, -0.45F));
  sun.intensity = {1.0F, 0.95F, 0.86F};
  scene.lights.push_back(sun);
  finish_scene(scene, {0.24F, 0.27F, 0.32F});
  return scene;
}

}  // namespace traces
