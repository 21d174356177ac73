#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "traces/scenes/forest/generator.h"
#include "traces/scenes/forest/textures.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::forest {
namespace {

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

/// Returns the places of some near trees, then of others round the clearing, `wanted` in all.
std::vector<Spot> tree_spots(std::size_t wanted) {
  std::vector<Spot> spots = {{0, -4.3F, 1.2F, 1.15F}, {1, 4.5F, 0.2F, 1.1F},  {2, 3.1F, -3.6F, 1},
                             {1, -2.9F, -4.6F, 1},    {0, 1.3F, -7.0F, 1.1F}, {2, -5.3F, -2.6F, 1.1F}};
  for (std::uint32_t k = 0; spots.size() < wanted && k < 400; ++k) {
    const glm::vec2 way = on_circle(static_cast<double>(random(41, k)));
    const float r = random_between(6, 26, 42, k);
    const glm::vec2 p = way * r;
    const bool crowded = std::ranges::any_of(spots, [&](const Spot& o) { return glm::distance(p, {o.x, o.z}) < 2.6F; });
    // The camera's lane must remain free.
    if (crowded || (p.y > 0 && std::abs(p.x) < 3.6F)) continue;
    spots.push_back(
        {static_cast<std::uint32_t>(random(43, k) * 2.999F), p.x, p.y, random_between(0.75F, 1.15F, 44, k)});
  }
  return spots;
}

}  // namespace

void Forest::add_trees() {
  const std::uint32_t oak =
      material(bark_texture("furrowed bark", {0.13F, 0.10F, 0.08F}, {0.66F, 0.56F, 0.45F}, 13, 21));
  const std::uint32_t beech = material(mossy_texture("mossy bark", {0.62F, 0.58F, 0.50F}, 22));
  const std::uint32_t birch = material(bark_texture("birch bark", {0.16F, 0.14F, 0.13F}, {0.95F, 0.93F, 0.87F}, 3, 23));
  scene_.textures[scene_.materials[beech].base_texture.texture].wrap_v = Texture::Wrap::kMirror;
  const std::uint32_t barks[] = {oak, beech, birch};
  const std::vector<Spot> spots = tree_spots(few(46));
  for (std::uint32_t kind = 0; kind < std::size(kKinds); ++kind) {
    TreeShape shape = kKinds[kind].shape;
    shape.sides = fine(10, 6);
    shape.branches = std::clamp(fine(static_cast<float>(shape.branches), 5), 5U, 16U);
    shape.twigs = std::clamp(fine(static_cast<float>(shape.twigs), 2), 2U, 7U);
    Tree tree = make_tree(kKinds[kind].name, shape, kind == 1 ? 2.2F : 1.4F);
    append(tree.wood, make_roots(shape.girth, fine(6, 4), 50 + kind));
    for (glm::vec2& uv : tree.wood.uvs) uv.x *= 2;
    const std::uint32_t mesh = add_mesh(scene_, std::move(tree.wood), barks[kind]);
    crowns_.push_back({std::move(tree.twigs), {}});
    for (std::size_t k = 0; k < spots.size(); ++k) {
      const Spot& p = spots[k];
      if (p.kind != kind) continue;
      const glm::mat4 at = placed(on_ground(p.x, p.z, -0.06F), static_cast<double>(random(45, k)), glm::vec3(p.size));
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
  const float rest = static_cast<float>(triangles_) - static_cast<float>(triangles_of(scene_));
  float trees = 0;
  for (const Crown& crown : crowns_) trees += static_cast<float>(crown.at.size());
  const auto count = static_cast<std::uint32_t>(std::max(rest, 0.02F * static_cast<float>(triangles_)) / 2 / trees);
  const float size = 0.75F * std::clamp(1 / detail_, 0.55F, 2.0F);
  const LeafShape leaf{.length = size, .width = 0.7F * size, .scatter = 0.7F};
  for (std::size_t k = 0; k < crowns_.size(); ++k) {
    const std::uint32_t green =
        material(foliage_texture("canopy", hues[k][0], hues[k][1], static_cast<std::uint32_t>(110 + k)));
    const std::uint32_t mesh =
        add_mesh(scene_, make_leaves("canopy", crowns_[k].twigs, count, leaf, {0, 9, 0}, 120 + k), green);
    for (const glm::mat4& at : crowns_[k].at) add_instance(scene_, mesh, at);
  }
}

}  // namespace traces::forest
