#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "traces/scenes/forest/generator.h"
#include "traces/scenes/forest/textures.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::forest {

void Forest::add_stones_and_logs() {
  constexpr glm::vec3 kRocks[] = {{0.55F, 0.52F, 0.48F}, {0.46F, 0.48F, 0.52F}};
  std::vector<std::uint32_t> meshes;
  for (std::uint32_t k = 0; k < 5; ++k) {
    if (k < 2) rocks_.push_back(material(mossy_texture("mossy rock", kRocks[k], 60 + k)));
    const glm::vec3 radii(random_between(0.8F, 1.2F, 61, k), random_between(0.5F, 0.8F, 62, k),
                          random_between(0.7F, 1.0F, 63, k));
    Mesh rock = make_rock("rock", radii, fine(12, 5), 0.5F, 64 + k);
    scale_uvs(rock, {1, 1 / 1.5F});
    meshes.push_back(add_mesh(scene_, std::move(rock), rocks_[k % 2]));
  }
  const glm::vec3 near[] = {{2.5F, 2.6F, 0.42F}, {3.1F, 1.95F, 0.62F}, {2.0F, 3.0F, 0.2F},   {-2.9F, 0.9F, 0.45F},
                            {-3.2F, 2.3F, 0.3F}, {0.6F, -3.2F, 0.7F},  {-3.4F, -3.0F, 0.8F}, {3.4F, -1.7F, 0.6F}};
  std::uint32_t count = 0;
  const auto put = [&](float x, float z, float size) {
    add_instance(scene_, meshes[count % meshes.size()],
                 placed(on_ground(x, z, -0.14F * size), static_cast<double>(random(65, count)), glm::vec3(size)));
    ++count;
  };
  for (const glm::vec3& p : near) put(p.x, p.y, p.z);
  for (std::uint32_t k = 0; k < 16; ++k) {
    const glm::vec2 p = on_circle(static_cast<double>(random(66, k))) * random_between(5.2F, 14, 67, k);
    if (p.y > 0 && std::abs(p.x) < 3.2F) continue;
    put(p.x, p.y, random_between(0.3F, 1.2F, 68, k));
  }
  const std::uint32_t log = add_mesh(scene_, make_log(3.6F, 0.24F, fine(18, 8), 71), log_bark_);
  add_instance(scene_, log, placed(on_ground(-2.9F, -0.5F, -0.03F), 0.09));
  add_instance(scene_, log, placed(on_ground(4.6F, -5.2F, 0.1F), -0.14, glm::vec3(1.2F)));
}

void Forest::add_ferns() {
  const std::uint32_t green = material(foliage_texture("fern", {0.10F, 0.24F, 0.05F}, {0.50F, 0.68F, 0.22F}, 81));
  const std::uint32_t pairs = fine(11, 5), fronds = fine(9, 5);
  const std::uint32_t meshes[] = {add_mesh(scene_, make_fern(fronds, pairs, 0.85F, 82), green),
                                  add_mesh(scene_, make_fern(fronds - 1, pairs, 0.6F, 83), green)};
  const glm::vec3 near[] = {{-2.55F, 3.2F, 0.8F}, {-3.0F, 1.7F, 1},     {-3.5F, 0.2F, 1.1F},   {2.95F, 2.9F, 0.75F},
                            {3.5F, 0.9F, 1.1F},   {3.3F, -0.9F, 1},     {-2.3F, -2.7F, 1.1F},  {0.5F, -3.9F, 1.1F},
                            {2.3F, -2.6F, 1},     {-4.4F, -1.2F, 1.1F}, {2.15F, 3.55F, 0.55F}, {-1.5F, 3.55F, 0.45F}};
  std::uint32_t count = 0;
  const auto put = [&](float x, float z, float size) {
    add_instance(scene_, meshes[count % 2],
                 placed(on_ground(x, z, -0.03F), static_cast<double>(random(84, count)), glm::vec3(size)));
    ++count;
  };
  for (const glm::vec3& p : near) put(p.x, p.y, p.z);
  for (std::uint32_t k = 0; count < few(52); ++k) {
    const glm::vec2 p = on_circle(static_cast<double>(random(85, k))) * random_between(4.2F, 13, 86, k);
    if (p.y > 0 && std::abs(p.x) < 2.8F) continue;
    put(p.x, p.y, random_between(0.8F, 1.5F, 87, k));
  }
}

void Forest::add_mushrooms() {
  std::vector<std::vector<std::uint32_t>> kinds;
  for (std::uint32_t kind = 0; kind < 2; ++kind) {
    kinds.emplace_back();
    for (const auto& [mesh, paint] :
         make_mushroom(0.13F, 0.3F + 0.4F * static_cast<float>(kind), fine(10, 6), caps_[kind], gills_, stem_)) {
      kinds.back().push_back(add_mesh(scene_, mesh, paint));
    }
  }
  constexpr glm::vec2 kGroups[] = {{-0.75F, 2.95F}, {1.3F, 2.6F},  {-2.2F, 0.5F},
                                   {1.0F, 0.9F},    {2.7F, -1.2F}, {-0.2F, 3.3F}};
  for (std::uint32_t g = 0; g < std::size(kGroups); ++g) {
    for (std::uint32_t k = 0; k < few(4); ++k) {
      const glm::vec2 p = kGroups[g] + 0.32F * (glm::vec2(random(91, g, k), random(92, g, k)) - 0.5F);
      const glm::mat4 at = placed(on_ground(p.x, p.y, -0.01F), static_cast<double>(random(93, g, k)),
                                  glm::vec3(random_between(0.5F, 1.15F, 94, g, k)));
      for (const std::uint32_t mesh : kinds[g % 2]) add_instance(scene_, mesh, at);
    }
  }
}

void Forest::fill() {
  const auto used = static_cast<std::uint32_t>(triangles_of(scene_));
  const float left =
      std::max(static_cast<float>(triangles_) - static_cast<float>(used), 0.05F * static_cast<float>(triangles_));
  add_undergrowth(left);
  add_bushes(left);
  add_canopy();
}

void Forest::add_undergrowth(float left) {
  const std::uint32_t blades = material(foliage_texture("grass", {0.16F, 0.30F, 0.06F}, {0.58F, 0.68F, 0.26F}, 102));
  constexpr std::uint32_t kPatches = 26, kTufts = 44;
  const auto leaves = static_cast<std::uint32_t>(0.25F * left / 2 / kPatches);
  const std::uint32_t patch = add_mesh(scene_, make_litter(1.5F, std::max(leaves, 4U), 103), litter_);
  const auto grass = static_cast<std::uint32_t>(0.2F * left / 5 / kTufts);
  const std::uint32_t tuft =
      add_mesh(scene_, make_grass("grass", std::max(grass, 4U), 3, 0.3F, 0.42F, 0.018F, 104), blades);
  for (std::uint32_t k = 0; k < kPatches; ++k) {
    const glm::vec2 p = on_circle(k * 0.381966) * (0.62F * std::sqrt(static_cast<float>(k) + 0.5F)) * 1.6F;
    const glm::vec3 foot = on_ground(p.x, p.y);
    const float e = 0.5F;
    const glm::vec3 u = glm::normalize(on_ground(p.x + e, p.y) - on_ground(p.x - e, p.y));
    const glm::vec3 n = glm::normalize(glm::cross(on_ground(p.x, p.y + e) - on_ground(p.x, p.y - e), u));
    add_instance(scene_, patch, {glm::vec4(u, 0), glm::vec4(n, 0), glm::vec4(glm::cross(u, n), 0), glm::vec4(foot, 1)});
  }
  for (std::uint32_t k = 0; k < kTufts; ++k) {
    const glm::vec2 p = on_circle(static_cast<double>(random(105, k))) * random_between(1.5F, 7, 106, k);
    add_instance(scene_, tuft,
                 placed(on_ground(p.x, p.y), static_cast<double>(random(107, k)),
                        glm::vec3(random_between(0.6F, 1.1F, 108, k))));
  }
}

void Forest::add_bushes(float left) {
  constexpr std::uint32_t kBushes = 18;
  const std::uint32_t shrub = material(foliage_texture("bush", {0.09F, 0.20F, 0.05F}, {0.42F, 0.58F, 0.18F}, 109));
  const auto many = std::max(static_cast<std::uint32_t>(0.22F * left / 2 / kBushes), 30U);
  const float broad = 0.2F * std::clamp(1 / detail_, 0.6F, 2.2F);
  const LeafShape small{.length = broad, .width = 0.65F * broad, .scatter = 0.25F};
  const std::uint32_t bush =
      add_mesh(scene_, make_leaves("bush", dome_twigs({1.1F, 1.5F, 1.1F}, 60, 6), many, small, {0, 0, 0}, 7), shrub);
  for (std::uint32_t k = 0; k < kBushes; ++k) {
    const glm::vec2 p = on_circle(-0.5 * (k + 0.5) / kBushes) * random_between(6.5F, 13, 8, k);
    add_instance(scene_, bush,
                 placed(on_ground(p.x, p.y, -0.1F), static_cast<double>(random(9, k)),
                        glm::vec3(random_between(0.7F, 1.3F, 10, k))));
  }
}

}  // namespace traces::forest
