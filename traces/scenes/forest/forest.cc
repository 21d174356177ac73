#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "traces/scene/cameras.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/forest/things.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/plants.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::forest {
namespace {

constexpr std::uint32_t kTriangles = 174'000;

/// Returns the height of the forest's ground in metres: uneven, but flat in the clearing.
float ground_height(float x, float z) {
  const float r = std::sqrt(x * x + z * z);
  const float t = std::clamp((r - 2.5F) / 9, 0.0F, 1.0F);
  return 2.6F * (fractal_noise(glm::vec3(x / 9, z / 9, 4), 3, 7) - 0.5F) * t * t * (3 - 2 * t);
}

glm::vec3 point_on_ground(float x, float z, float above = 0) { return {x, ground_height(x, z) + above, z}; }

/// Generates the forest part by part. Contains the scene so far and its level of detail.
class Forest {
 public:
  Forest(Scene& scene, std::uint32_t triangles)
      : scene_(scene),
        triangles_(triangles),
        detail_(std::sqrt(static_cast<float>(triangles) / static_cast<float>(kTriangles))) {}

  void fill_scene();

 private:
  std::uint32_t scaled_count(float n, std::uint32_t least) const {
    return std::max(static_cast<std::uint32_t>(n * detail_ + 0.5F), least);
  }

  /// Returns `n`, or a smaller number of objects for a scene of few triangles.
  std::uint32_t capped_count(float n) const { return static_cast<std::uint32_t>(n * std::min(detail_, 1.0F) + 0.5F); }

  void show_pieces(const Pieces& pieces, const glm::mat4& at, bool focus);

  void add_floor();
  /// Adds a panorama of deeper forest on all sides.
  void add_backdrop();
  void add_trees();
  void add_focus();
  void add_stones_and_logs();
  void add_ferns();
  void add_mushrooms();
  /// Adds undergrowth, bushes and canopy until the scene has the requested number of triangles.
  void add_leaves();
  // `left` is the number of triangles that remain.
  void add_undergrowth(float left);
  void add_bushes(float left);
  void add_canopy();

  struct Crown {
    std::vector<Twig> twigs;
    std::vector<glm::mat4> at;
  };
  Scene& scene_;
  std::uint32_t triangles_;
  float detail_;
  std::vector<Crown> crowns_;
  std::vector<std::uint32_t> caps_, rocks_;
  std::uint32_t gills_ = 0, stem_ = 0, log_bark_ = 0, litter_ = 0;
};

void Forest::fill_scene() {
  add_floor();
  add_backdrop();
  add_trees();
  add_focus();
  add_stones_and_logs();
  add_ferns();
  add_mushrooms();
  add_leaves();
}

void Forest::show_pieces(const Pieces& pieces, const glm::mat4& at, bool focus) {
  for (const auto& [mesh, paint] : pieces) {
    scene_.instances[add_instance(scene_, add_mesh(scene_, mesh, paint), at)].focus = focus;
  }
}

void Forest::add_floor() {
  const std::uint32_t cells = scaled_count(84, 24);
  Mesh floor = make_surface("forest floor", cells, cells, [](float s, float t) {
    const glm::vec2 p = (glm::vec2(s, 1 - t) - 0.5F) * 64.0F;
    // Plants are denser in the middle.
    const glm::vec2 near = p * (0.35F + 0.65F * glm::abs(p) / 32.0F);
    return point_on_ground(near.x, near.y);
  });
  for (std::size_t i = 0; i < floor.uvs.size(); ++i) {
    floor.uvs[i] = glm::vec2(floor.positions[i].x, floor.positions[i].z) / 2.6F;
  }
  litter_ = add_textured(scene_, litter_texture("leaf litter", 2600, 3));
  add_object(scene_, std::move(floor), litter_);
}

void Forest::add_backdrop() {
  constexpr float kRadius = 31;
  Mesh round = make_surface(
      "deep forest", scaled_count(40, 20), 4,
      [](float s, float t) {
        const glm::vec2 way = circle_point(static_cast<double>(s)) * kRadius;
        return glm::vec3(way.x, -3 + 17 * t, way.y);
      },
      true);
  for (glm::vec2& uv : round.uvs) uv = {5 * uv.x, 1 - uv.y};
  const std::uint32_t deep = add_textured(scene_, deep_forest_texture("deep forest"));
  scene_.textures.back().wrap_v = Texture::Wrap::kClamp;
  add_object(scene_, std::move(round), deep);
}

void Forest::add_focus() {
  const std::uint32_t fur = add_textured(scene_, fur_texture("deer fur"));
  const std::uint32_t horn =
      add_textured(scene_, bark_texture("antler", {0.42F, 0.33F, 0.24F}, {0.88F, 0.80F, 0.66F}, 6, 51, 256));
  const std::uint32_t dark = add_material(scene_, make_paint("hoof and eye", {0.02F, 0.016F, 0.014F}, 0.12F));
  show_pieces(make_deer(scaled_count(18, 8), fur, horn, dark), placement_at(point_on_ground(-1.0F, -1.5F), 0.06), true);

  const std::uint32_t wood =
      add_textured(scene_, wood_texture("bench wood", {0.72F, 0.56F, 0.38F}, {0.36F, 0.24F, 0.15F}, 52));
  const std::uint32_t iron = add_material(scene_, make_paint("iron", {0.05F, 0.05F, 0.06F}, 0.15F));
  const std::uint32_t flame = add_material(scene_, make_lamp("flame", {34, 22, 9}));
  const glm::mat4 bench = placement_at(point_on_ground(1.75F, -0.1F), -0.06);
  show_pieces(make_bench(wood, iron), bench, true);
  show_pieces(make_lantern(iron, flame), bench * placement_at({0.45F, 0.46F, 0}), true);

  caps_ = {add_textured(scene_, cap_texture("fly agaric", {0.80F, 0.10F, 0.05F}, 53)),
           add_textured(scene_, cap_texture("brown cap", {0.55F, 0.34F, 0.18F}, 54))};
  gills_ = add_textured(scene_, gills_texture("gills"));
  stem_ = add_textured(scene_, bark_texture("stem", {0.74F, 0.68F, 0.56F}, {0.98F, 0.95F, 0.88F}, 12, 55, 256));
  constexpr float kBig[][4] = {
      {-1.62F, 2.35F, 0.5F, 0.25F}, {-1.12F, 2.62F, 0.33F, 0.5F}, {-2.02F, 2.75F, 0.27F, 0.9F}};
  for (const auto& m : kBig) {
    show_pieces(make_mushroom(m[2], m[3], scaled_count(36, 12), caps_[0], gills_, stem_),
                placement_at(point_on_ground(m[0], m[1])), true);
  }
}

struct Kind {
  const char* name;
  TreeShape shape;
};
constexpr Kind kKinds[] = {{"oak",
                            {.height = 15,
                             .girth = 0.46F,
                             .bare = 0.36F,
                             .reach = 4.6F,
                             .rise = 0.5F,
                             .crooked = 0.2F,
                             .branches = 7,
                             .twigs = 3,
                             .seed = 31}},
                           {"beech",
                            {.height = 17,
                             .girth = 0.36F,
                             .bare = 0.42F,
                             .reach = 4,
                             .rise = 0.7F,
                             .crooked = 0.12F,
                             .branches = 7,
                             .twigs = 3,
                             .seed = 32}},
                           {"birch",
                            {.height = 13,
                             .girth = 0.17F,
                             .bare = 0.4F,
                             .reach = 2.8F,
                             .rise = 0.9F,
                             .crooked = 0.16F,
                             .branches = 7,
                             .twigs = 3,
                             .seed = 33}}};

struct Spot {
  std::uint32_t kind;
  float x, z, size;
};

/// Returns `wanted` places for trees: first some near the clearing, then others around it.
std::vector<Spot> tree_spots(std::size_t wanted) {
  std::vector<Spot> spots = {{0, -4.3F, 1.2F, 1.15F}, {1, 4.5F, 0.2F, 1.1F},  {2, 3.1F, -3.6F, 1},
                             {1, -2.9F, -4.6F, 1},    {0, 1.3F, -7.0F, 1.1F}, {2, -5.3F, -2.6F, 1.1F}};
  for (std::uint32_t k = 0; spots.size() < wanted && k < 400; ++k) {
    const glm::vec2 way = circle_point(static_cast<double>(random_unit(41, k)));
    const float r = random_between(6, 26, 42, k);
    const glm::vec2 p = way * r;
    const bool crowded = std::ranges::any_of(spots, [&](const Spot& o) { return glm::distance(p, {o.x, o.z}) < 2.6F; });
    // The lane of the camera remains free.
    if (crowded || (p.y > 0 && std::abs(p.x) < 3.6F)) continue;
    spots.push_back(
        {static_cast<std::uint32_t>(random_unit(43, k) * 2.999F), p.x, p.y, random_between(0.75F, 1.15F, 44, k)});
  }
  return spots;
}

void Forest::add_trees() {
  const std::uint32_t oak =
      add_textured(scene_, bark_texture("furrowed bark", {0.13F, 0.10F, 0.08F}, {0.66F, 0.56F, 0.45F}, 13, 21));
  const std::uint32_t beech = add_textured(scene_, mossy_texture("mossy bark", {0.62F, 0.58F, 0.50F}, 22));
  const std::uint32_t birch =
      add_textured(scene_, bark_texture("birch bark", {0.16F, 0.14F, 0.13F}, {0.95F, 0.93F, 0.87F}, 3, 23));
  scene_.textures[scene_.materials[beech].base_texture.texture].wrap_v = Texture::Wrap::kMirror;
  const std::uint32_t barks[] = {oak, beech, birch};
  const std::vector<Spot> spots = tree_spots(capped_count(46));
  for (std::uint32_t kind = 0; kind < std::size(kKinds); ++kind) {
    TreeShape shape = kKinds[kind].shape;
    shape.sides = scaled_count(10, 6);
    shape.branches = std::clamp(scaled_count(static_cast<float>(shape.branches), 5), 5U, 16U);
    shape.twigs = std::clamp(scaled_count(static_cast<float>(shape.twigs), 2), 2U, 7U);
    Tree tree = make_tree(kKinds[kind].name, shape, kind == 1 ? 2.2F : 1.4F);
    append_mesh(tree.wood, make_roots(shape.girth, scaled_count(6, 4), 50 + kind));
    for (glm::vec2& uv : tree.wood.uvs) uv.x *= 2;
    const std::uint32_t mesh = add_mesh(scene_, std::move(tree.wood), barks[kind]);
    crowns_.push_back({std::move(tree.twigs), {}});
    for (std::size_t k = 0; k < spots.size(); ++k) {
      const Spot& p = spots[k];
      if (p.kind != kind) continue;
      const glm::mat4 at =
          placement_at(point_on_ground(p.x, p.z, -0.06F), static_cast<double>(random_unit(45, k)), glm::vec3(p.size));
      add_instance(scene_, mesh, at);
      crowns_.back().at.push_back(at);
    }
  }
  log_bark_ = oak;
}

void Forest::add_canopy() {
  const glm::vec3 hues[][2] = {{{0.14F, 0.26F, 0.06F}, {0.52F, 0.62F, 0.18F}},
                               {{0.24F, 0.32F, 0.07F}, {0.68F, 0.70F, 0.22F}},
                               {{0.38F, 0.36F, 0.08F}, {0.84F, 0.74F, 0.26F}}};
  const float rest = static_cast<float>(triangles_) - static_cast<float>(count_triangles(scene_));
  float trees = 0;
  for (const Crown& crown : crowns_) trees += static_cast<float>(crown.at.size());
  const auto count = static_cast<std::uint32_t>(std::max(rest, 0.02F * static_cast<float>(triangles_)) / 2 / trees);
  const float size = 0.75F * std::clamp(1 / detail_, 0.55F, 2.0F);
  const LeafShape leaf{.length = size, .width = 0.7F * size, .scatter = 0.7F};
  for (std::size_t k = 0; k < crowns_.size(); ++k) {
    const std::uint32_t green =
        add_textured(scene_, foliage_texture("canopy", hues[k][0], hues[k][1], static_cast<std::uint32_t>(110 + k)));
    const std::uint32_t mesh =
        add_mesh(scene_, make_leaves("canopy", crowns_[k].twigs, count, leaf, {0, 9, 0}, 120 + k), green);
    for (const glm::mat4& at : crowns_[k].at) add_instance(scene_, mesh, at);
  }
}

void Forest::add_stones_and_logs() {
  constexpr glm::vec3 kRocks[] = {{0.55F, 0.52F, 0.48F}, {0.46F, 0.48F, 0.52F}};
  std::vector<std::uint32_t> meshes;
  for (std::uint32_t k = 0; k < 5; ++k) {
    if (k < 2) rocks_.push_back(add_textured(scene_, mossy_texture("mossy rock", kRocks[k], 60 + k)));
    const glm::vec3 radii(random_between(0.8F, 1.2F, 61, k), random_between(0.5F, 0.8F, 62, k),
                          random_between(0.7F, 1.0F, 63, k));
    Mesh rock = make_rock("rock", radii, scaled_count(12, 5), 0.5F, 64 + k);
    scale_uvs(rock, {1, 1 / 1.5F});
    meshes.push_back(add_mesh(scene_, std::move(rock), rocks_[k % 2]));
  }
  const glm::vec3 near[] = {{2.5F, 2.6F, 0.42F}, {3.1F, 1.95F, 0.62F}, {2.0F, 3.0F, 0.2F},   {-2.9F, 0.9F, 0.45F},
                            {-3.2F, 2.3F, 0.3F}, {0.6F, -3.2F, 0.7F},  {-3.4F, -3.0F, 0.8F}, {3.4F, -1.7F, 0.6F}};
  std::uint32_t count = 0;
  const auto put = [&](float x, float z, float size) {
    add_instance(scene_, meshes[count % meshes.size()],
                 placement_at(point_on_ground(x, z, -0.14F * size), static_cast<double>(random_unit(65, count)),
                              glm::vec3(size)));
    ++count;
  };
  for (const glm::vec3& p : near) put(p.x, p.y, p.z);
  for (std::uint32_t k = 0; k < 16; ++k) {
    const glm::vec2 p = circle_point(static_cast<double>(random_unit(66, k))) * random_between(5.2F, 14, 67, k);
    if (p.y > 0 && std::abs(p.x) < 3.2F) continue;
    put(p.x, p.y, random_between(0.3F, 1.2F, 68, k));
  }
  const std::uint32_t log = add_mesh(scene_, make_log(3.6F, 0.24F, scaled_count(18, 8), 71), log_bark_);
  add_instance(scene_, log, placement_at(point_on_ground(-2.9F, -0.5F, -0.03F), 0.09));
  add_instance(scene_, log, placement_at(point_on_ground(4.6F, -5.2F, 0.1F), -0.14, glm::vec3(1.2F)));
}

void Forest::add_ferns() {
  const std::uint32_t green =
      add_textured(scene_, foliage_texture("fern", {0.10F, 0.24F, 0.05F}, {0.50F, 0.68F, 0.22F}, 81));
  const std::uint32_t pairs = scaled_count(11, 5), fronds = scaled_count(9, 5);
  const std::uint32_t meshes[] = {add_mesh(scene_, make_fern(fronds, pairs, 0.85F, 82), green),
                                  add_mesh(scene_, make_fern(fronds - 1, pairs, 0.6F, 83), green)};
  const glm::vec3 near[] = {{-2.55F, 3.2F, 0.8F}, {-3.0F, 1.7F, 1},     {-3.5F, 0.2F, 1.1F},   {2.95F, 2.9F, 0.75F},
                            {3.5F, 0.9F, 1.1F},   {3.3F, -0.9F, 1},     {-2.3F, -2.7F, 1.1F},  {0.5F, -3.9F, 1.1F},
                            {2.3F, -2.6F, 1},     {-4.4F, -1.2F, 1.1F}, {2.15F, 3.55F, 0.55F}, {-1.5F, 3.55F, 0.45F}};
  std::uint32_t count = 0;
  const auto put = [&](float x, float z, float size) {
    add_instance(
        scene_, meshes[count % 2],
        placement_at(point_on_ground(x, z, -0.03F), static_cast<double>(random_unit(84, count)), glm::vec3(size)));
    ++count;
  };
  for (const glm::vec3& p : near) put(p.x, p.y, p.z);
  for (std::uint32_t k = 0; count < capped_count(52); ++k) {
    const glm::vec2 p = circle_point(static_cast<double>(random_unit(85, k))) * random_between(4.2F, 13, 86, k);
    if (p.y > 0 && std::abs(p.x) < 2.8F) continue;
    put(p.x, p.y, random_between(0.8F, 1.5F, 87, k));
  }
}

void Forest::add_mushrooms() {
  std::vector<std::vector<std::uint32_t>> kinds;
  for (std::uint32_t kind = 0; kind < 2; ++kind) {
    kinds.emplace_back();
    for (const auto& [mesh, paint] : make_mushroom(0.13F, 0.3F + 0.4F * static_cast<float>(kind), scaled_count(10, 6),
                                                   caps_[kind], gills_, stem_)) {
      kinds.back().push_back(add_mesh(scene_, mesh, paint));
    }
  }
  constexpr glm::vec2 kGroups[] = {{-0.75F, 2.95F}, {1.3F, 2.6F},  {-2.2F, 0.5F},
                                   {1.0F, 0.9F},    {2.7F, -1.2F}, {-0.2F, 3.3F}};
  for (std::uint32_t g = 0; g < std::size(kGroups); ++g) {
    for (std::uint32_t k = 0; k < capped_count(4); ++k) {
      const glm::vec2 p = kGroups[g] + 0.32F * (glm::vec2(random_unit(91, g, k), random_unit(92, g, k)) - 0.5F);
      const glm::mat4 at = placement_at(point_on_ground(p.x, p.y, -0.01F), static_cast<double>(random_unit(93, g, k)),
                                        glm::vec3(random_between(0.5F, 1.15F, 94, g, k)));
      for (const std::uint32_t mesh : kinds[g % 2]) add_instance(scene_, mesh, at);
    }
  }
}

void Forest::add_leaves() {
  const auto used = static_cast<std::uint32_t>(count_triangles(scene_));
  const float left =
      std::max(static_cast<float>(triangles_) - static_cast<float>(used), 0.05F * static_cast<float>(triangles_));
  add_undergrowth(left);
  add_bushes(left);
  add_canopy();
}

void Forest::add_undergrowth(float left) {
  const std::uint32_t blades =
      add_textured(scene_, foliage_texture("grass", {0.16F, 0.30F, 0.06F}, {0.58F, 0.68F, 0.26F}, 102));
  constexpr std::uint32_t kPatches = 26, kTufts = 44;
  const auto leaves = static_cast<std::uint32_t>(0.25F * left / 2 / kPatches);
  const std::uint32_t patch = add_mesh(scene_, make_litter(1.5F, std::max(leaves, 4U), 103), litter_);
  const auto grass = static_cast<std::uint32_t>(0.2F * left / 5 / kTufts);
  const std::uint32_t tuft =
      add_mesh(scene_, make_grass("grass", std::max(grass, 4U), 3, 0.3F, 0.42F, 0.018F, 104), blades);
  for (std::uint32_t k = 0; k < kPatches; ++k) {
    const glm::vec2 p = circle_point(k * 0.381966) * (0.62F * std::sqrt(static_cast<float>(k) + 0.5F)) * 1.6F;
    const glm::vec3 foot = point_on_ground(p.x, p.y);
    const float e = 0.5F;
    const glm::vec3 u = glm::normalize(point_on_ground(p.x + e, p.y) - point_on_ground(p.x - e, p.y));
    const glm::vec3 n = glm::normalize(glm::cross(point_on_ground(p.x, p.y + e) - point_on_ground(p.x, p.y - e), u));
    add_instance(scene_, patch, {glm::vec4(u, 0), glm::vec4(n, 0), glm::vec4(glm::cross(u, n), 0), glm::vec4(foot, 1)});
  }
  for (std::uint32_t k = 0; k < kTufts; ++k) {
    const glm::vec2 p = circle_point(static_cast<double>(random_unit(105, k))) * random_between(1.5F, 7, 106, k);
    add_instance(scene_, tuft,
                 placement_at(point_on_ground(p.x, p.y), static_cast<double>(random_unit(107, k)),
                              glm::vec3(random_between(0.6F, 1.1F, 108, k))));
  }
}

void Forest::add_bushes(float left) {
  constexpr std::uint32_t kBushes = 18;
  const std::uint32_t shrub =
      add_textured(scene_, foliage_texture("bush", {0.09F, 0.20F, 0.05F}, {0.42F, 0.58F, 0.18F}, 109));
  const auto many = std::max(static_cast<std::uint32_t>(0.22F * left / 2 / kBushes), 30U);
  const float broad = 0.2F * std::clamp(1 / detail_, 0.6F, 2.2F);
  const LeafShape small{.length = broad, .width = 0.65F * broad, .scatter = 0.25F};
  const std::uint32_t bush =
      add_mesh(scene_, make_leaves("bush", dome_twigs({1.1F, 1.5F, 1.1F}, 60, 6), many, small, {0, 0, 0}, 7), shrub);
  for (std::uint32_t k = 0; k < kBushes; ++k) {
    const glm::vec2 p = circle_point(-0.5 * (k + 0.5) / kBushes) * random_between(6.5F, 13, 8, k);
    add_instance(scene_, bush,
                 placement_at(point_on_ground(p.x, p.y, -0.1F), static_cast<double>(random_unit(9, k)),
                              glm::vec3(random_between(0.7F, 1.3F, 10, k))));
  }
}

}  // namespace
}  // namespace traces::forest

namespace traces {

Scene build_forest(const BuiltinOptions& options) {
  constexpr float kFov = 0.66F;
  Scene scene;
  scene.name = "forest";
  scene.background = {0.66F, 0.76F, 0.72F};
  forest::Forest(scene, options.triangles_or_default(forest::kTriangles)).fill_scene();
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(0.42F, -0.82F, -0.38F));
  sun.intensity = {1, 0.93F, 0.76F};
  scene.lights.push_back(sun);
  scene.cameras.push_back(look_at("clearing", {-0.5F, 1.35F, 6.3F}, {0.15F, 0.82F, -1.0F}, kFov));
  scene.cameras.push_back(look_at("mushrooms", {-0.7F, 0.5F, 4.1F}, {-1.5F, 0.28F, 2.4F}, kFov));
  scene.cameras.push_back(look_at("deer", {0.6F, 1.3F, 1.6F}, {-0.7F, 1.15F, -1.5F}, kFov));
  const ViewKey keys[] = {
      {0, {-0.5F, 1.35F, 6.3F}, {0.15F, 0.82F, -1.0F}},  {3, {-0.4F, 0.8F, 4.4F}, {-1.4F, 0.4F, 2.3F}},
      {5.5F, {0.5F, 0.9F, 3.2F}, {-0.9F, 0.8F, 0}},      {8, {0.9F, 1.3F, 1.9F}, {-0.8F, 1.2F, -1.5F}},
      {10.5F, {0.4F, 1.35F, 1.8F}, {1.8F, 0.6F, -0.1F}}, {13, {-0.9F, 1.6F, 3.0F}, {1.0F, 2.2F, -2}},
      {15, {-0.5F, 1.35F, 6.3F}, {0.15F, 0.82F, -1.0F}}};
  add_camera_path(scene, "path", keys, kFov);
  finish_scene(scene, {0.33F, 0.37F, 0.35F});
  return scene;
}

}  // namespace traces
