#include <array>
#include <vector>

#include "traces/scenes/atrium/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::atrium {
namespace {

void upright_picture(Mesh& mesh) {
  for (glm::vec2& uv : mesh.uvs) uv.y = 1 - uv.y;
}

}  // namespace

void add_cloth(Scene& scene, const Materials& is, const Detail& detail) {
  // Banners over the balustrades, at every other column.
  constexpr float kWide = 0.95F, kTall = 3.1F;
  Mesh cloth = make_surface("banner", detail.cells(10, 4), detail.cells(18, 6), [](float s, float t) {
    const float down = 1 - t;
    const float wave = 0.05F * down * sin_turns(static_cast<double>(0.8F * s + 1.1F * t)) +
                       0.025F * down * sin_turns(static_cast<double>(2.0F * s - 0.7F * t));
    const float point = 0.22F * down * down * (2 * s - 1) * (2 * s - 1);
    return glm::vec3((s - 0.5F) * kWide, kTall * (t - 1) + point, wave);
  });
  upright_picture(cloth);
  const std::uint32_t red = add_mesh(scene, cloth, is.red), blue = add_mesh(scene, std::move(cloth), is.blue);
  const std::uint32_t rod = add_mesh(scene,
                                     transformed(make_cylinder("banner rod", 0.022F, 1.15F, detail.cells(8, 4)),
                                                 turned({0.575F, 0, 0}, {0, 0, 1}, 0.25)),
                                     is.iron);
  const std::uint32_t arm = add_mesh(scene,
                                     transformed(make_cylinder("banner arm", 0.018F, 0.45F, detail.cells(8, 4)),
                                                 turned({0, 0, -0.42F}, {1, 0, 0}, 0.25)),
                                     is.iron);
  const auto add_banner = [&](const glm::vec3& at, const glm::vec3& inward, std::uint32_t which) {
    const glm::mat4 to_world = standing(at, inward);
    add_instance(scene, which, to_world);
    add_instance(scene, rod, to_world);
    add_instance(scene, arm, to_world);
  };
  for (int k = 1; k < kLongBays; k += 2) {
    const float x = kLongBay * static_cast<float>(k) - kHalfLength;
    for (const float side : {-1.0F, 1.0F}) {
      add_banner({x, kUpper + 1.1F, side * (kHalfWidth - 0.55F)}, {0, 0, -side}, (k / 2) % 2 == 0 ? red : blue);
    }
  }
  // Curtains in some of the lower arches.
  const float half = kLongBay / 2 - 0.24F;
  Mesh curtain = make_curtain("curtain", half, 2.62F, 5, 0.07F, detail.cells(30, 10), detail.cells(10, 3), 77);
  upright_picture(curtain);
  const std::uint32_t curtain_mesh = add_mesh(scene, std::move(curtain), is.curtain);
  const std::uint32_t pole = add_mesh(scene,
                                      transformed(make_cylinder("curtain pole", 0.025F, 2 * half, detail.cells(8, 4)),
                                                  turned({half, 0, 0}, {0, 0, 1}, 0.25)),
                                      is.iron);
  for (const auto& [bay, side, both] : {std::tuple{1, -1.0F, true},
                                        {3, -1.0F, false},
                                        {4, -1.0F, true},
                                        {0, 1.0F, false},
                                        {3, 1.0F, true},
                                        {5, 1.0F, true}}) {
    const float x = kLongBay * (static_cast<float>(bay) + 0.5F) - kHalfLength;
    const glm::mat4 at = standing({x, 0.12F, side * kHalfWidth}, {0, 0, -side});
    add_instance(scene, pole, at * placed({0, 2.62F, 0}));
    add_instance(scene, curtain_mesh, at * placed({-half, 0, 0}, 0, {both ? 0.75F : 0.95F, 1, 1}));
    if (both) add_instance(scene, curtain_mesh, at * placed({0.25F * half, 0, 0}, 0, {0.75F, 1, 1}));
  }
}

void add_fountain(Scene& scene, const Materials& is, const Detail& detail) {
  const glm::mat4 at = placed({2.6F, 0, 0});
  const auto add_lathe = [&](const char* name, std::span<const glm::vec2> profile, std::uint32_t segments,
                             std::uint32_t material) {
    Mesh mesh = make_lathe(name, detail.profile(profile), segments);
    project_uvs(mesh, 0.6F);
    add_object(scene, transformed(std::move(mesh), at), material);
  };
  const std::uint32_t round = detail.cells(28, 12);
  const glm::vec2 step[] = {{1.75F, 0}, {1.75F, 0.12F}, {1.3F, 0.12F}};
  const glm::vec2 rim[] = {{1.35F, 0.12F}, {1.35F, 0.2F},  {1.25F, 0.24F}, {1.25F, 0.5F},
                           {1.36F, 0.54F}, {1.36F, 0.62F}, {1.12F, 0.62F}, {1.12F, 0.3F}};
  const glm::vec2 pool[] = {{1.13F, 0.5F}, {0, 0.5F}};
  const glm::vec2 foot[] = {{0.3F, 0.4F},   {0.3F, 0.55F},  {0.16F, 0.65F}, {0.13F, 0.8F},
                            {0.2F, 0.95F},  {0.12F, 1.1F},  {0.14F, 1.2F},  {0.45F, 1.3F},
                            {0.62F, 1.42F}, {0.64F, 1.46F}, {0.58F, 1.44F}, {0.4F, 1.36F}};
  const glm::vec2 upper_pool[] = {{0.56F, 1.42F}, {0, 1.42F}};
  const glm::vec2 finial[] = {{0.07F, 1.36F}, {0.06F, 1.55F}, {0.12F, 1.66F},
                              {0.13F, 1.74F}, {0.05F, 1.86F}, {0, 1.9F}};
  add_lathe("fountain step", step, 8, is.light_stone);
  add_lathe("fountain rim", rim, 8, is.stone);
  add_lathe("fountain water", pool, 8, is.water);
  add_lathe("fountain bowl", smoothed(foot, detail.cells(2)), round, is.stone);
  add_lathe("fountain bowl's water", upper_pool, round, is.water);
  add_lathe("finial", smoothed(finial, detail.cells(2)), round, is.light_stone);
}

void add_plants(Scene& scene, const Materials& is, const Detail& detail) {
  const glm::vec2 pot[] = {{0, 0},         {0.2F, 0},     {0.24F, 0.04F}, {0.33F, 0.3F},  {0.3F, 0.5F},
                           {0.27F, 0.55F}, {0.33F, 0.6F}, {0.34F, 0.65F}, {0.28F, 0.65F}, {0.25F, 0.58F}};
  const glm::vec2 ground[] = {{0.26F, 0.59F}, {0, 0.62F}};
  const std::uint32_t round = detail.cells(22, 8);
  const std::uint32_t pot_mesh = add_mesh(scene, make_lathe("pot", detail.profile(pot), round), is.clay);
  const std::uint32_t soil_mesh = add_mesh(scene, make_lathe("soil", detail.profile(ground), round), is.soil);
  const glm::vec3 positions[] = {{-5.9F, 0, 2.75F}, {-6.1F, 0, -2.75F}, {-0.2F, 0, -2.75F},
                                 {0.1F, 0, 2.75F},  {5.9F, 0, -2.75F},  {6.1F, 0, 2.75F}};
  std::uint32_t seed = 90;
  for (const glm::vec3& at : positions) {
    ++seed;
    add_instance(scene, pot_mesh, placed(at));
    add_instance(scene, soil_mesh, placed(at));
    Mesh foliage;
    foliage.name = "foliage";
    const std::uint32_t count = detail.pieces(70, 12);
    for (std::uint32_t k = 0; k < count; ++k) {
      const float age = (static_cast<float>(k) + 0.5F) / static_cast<float>(count);
      const glm::vec2 way = on_circle(static_cast<double>(0.382F * static_cast<float>(k)));
      const float rise = 2.4F - 2.0F * age + 0.5F * random(seed, k);
      const float length = random_between(0.7F, 1.0F, seed, k, 1) * (1.15F - 0.3F * age);
      add_leaf(foliage, at + glm::vec3(0.1F * way.x, 0.6F, 0.1F * way.y), glm::normalize(glm::vec3(way.x, rise, way.y)),
               length, 0.075F, 0.25F + 0.5F * age, detail.cells(6, 3));
    }
    add_object(scene, std::move(foliage), is.leaf);
  }
}

void add_lanterns(Scene& scene, const Materials& is, const Detail& detail) {
  const std::uint32_t round = detail.cells(10, 6);
  const glm::vec2 hood[] = {{0.13F, 0.28F}, {0.14F, 0.3F},   {0.05F, 0.38F},
                            {0.02F, 0.42F}, {0.012F, 0.46F}, {0.012F, 1.05F}};
  const glm::vec2 base[] = {{0, -0.05F}, {0.03F, -0.02F}, {0.11F, 0}, {0.11F, 0.03F}, {0, 0.03F}};
  Mesh frame = make_lathe("lantern", detail.profile(hood), round);
  append(frame, make_lathe("", detail.profile(base), round));
  for (int k = 0; k < 6; ++k) {
    const glm::vec2 p = on_circle(k / 6.0);
    append(frame, make_tube("",
                            std::array{glm::vec3(0.105F * p.x, 0.02F, 0.105F * p.y),
                                       glm::vec3(0.125F * p.x, 0.29F, 0.125F * p.y)},
                            std::array{0.006F}, 4));
  }
  const glm::vec2 flame[] = {{0.05F, 0.03F}, {0.075F, 0.12F}, {0.06F, 0.22F}, {0, 0.27F}};
  const std::uint32_t frame_mesh = add_mesh(scene, std::move(frame), is.iron);
  const std::uint32_t flame_mesh =
      add_mesh(scene, make_lathe("lantern's light", smoothed(detail.profile(flame), 2), round), is.glow);
  int count = 0;
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float) {
    if (count++ % 2 == 0) return;
    const glm::mat4 at = placed(middle - 1.5F * inward + glm::vec3(0, kUpper - 0.4F - 1.05F, 0));
    add_instance(scene, frame_mesh, at);
    add_instance(scene, flame_mesh, at);
  });
}

}  // namespace traces::atrium
