#include <array>
#include <vector>

#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::bathroom {
namespace {

/// Adds a bottle with shoulders, and its screw cap.
void add_bottle(Scene& scene, const Detail& detail, const glm::vec3& at, float radius, float height, std::uint32_t body,
                std::uint32_t cap) {
  const std::uint32_t round = detail.cells(32, 10);
  const glm::vec2 shape[] = {
      {0.85F * radius, 0},      {radius, 0.04F * height},        {radius, 0.4F * height},
      {radius, 0.75F * height}, {0.8F * radius, 0.87F * height}, {0.38F * radius, 0.93F * height},
      {0.35F * radius, height}};
  add_object(scene,
             transformed(make_lathe("bottle", smoothed(detail.profile(shape), detail.cells(4, 2)), round), placed(at)),
             body);
  std::vector<glm::vec2> top{{0.45F * radius, 0}};
  for (int k = 0; k < 4; ++k) {
    const float y = 0.012F * static_cast<float>(k);
    top.emplace_back(0.5F * radius, y + 0.002F);
    top.emplace_back(0.5F * radius, y + 0.008F);
    top.emplace_back(0.47F * radius, y + 0.009F);
    top.emplace_back(0.47F * radius, y + 0.011F);
  }
  top.emplace_back(0.46F * radius, 0.05F);
  top.emplace_back(0, 0.051F);
  add_object(scene,
             transformed(make_lathe("cap", detail.profile(top), round), placed(at + glm::vec3(0, 0.95F * height, 0))),
             cap);
}

/// Adds a soap dispenser with a pump.
void add_dispenser(Scene& scene, const Materials& is, const Detail& detail, const glm::vec3& at) {
  const std::uint32_t round = detail.cells(36, 12);
  const glm::vec2 body[] = {{0.034F, 0},      {0.04F, 0.006F},  {0.041F, 0.05F}, {0.041F, 0.1F},
                            {0.036F, 0.118F}, {0.018F, 0.128F}, {0.016F, 0.132F}};
  add_object(
      scene,
      transformed(make_lathe("soap dispenser", smoothed(detail.profile(body), detail.cells(4, 2)), round), placed(at)),
      is.amber);
  const glm::vec2 collar[] = {{0.019F, 0.128F}, {0.019F, 0.143F}, {0.006F, 0.145F}, {0.006F, 0.165F},
                              {0.013F, 0.167F}, {0.013F, 0.178F}, {0, 0.18F}};
  Mesh pump = make_lathe("pump", detail.profile(collar), detail.cells(20, 8));
  const glm::vec3 spout[] = {{0, 0.172F, 0}, {0, 0.174F, 0.025F}, {0, 0.172F, 0.045F}, {0, 0.16F, 0.052F}};
  append(pump, make_tube("", smoothed(spout, detail.cells(5, 2)), std::array{0.0045F}, detail.cells(10, 4)));
  add_object(scene, transformed(std::move(pump), placed(at, 0.05)), is.chrome);
}

/// Makes bristles along +y on a rectangle around the origin.
Mesh make_bristles(std::string name, float half_length, float half_width, float tall, float radius,
                   std::uint32_t columns, std::uint32_t rows) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const float u = 2 * (static_cast<float>(i) + 0.5F) / static_cast<float>(columns) - 1;
      const float v = 2 * (static_cast<float>(j) + 0.5F) / static_cast<float>(rows) - 1;
      if (u * u * u * u + v * v * v * v > 1) continue;
      const float bend = 0.12F * tall * (random(i, j, 21) - 0.5F);
      const glm::vec3 root(half_length * u, 0, half_width * v);
      append(mesh,
             make_tube("", std::array{root, root + glm::vec3(bend + 0.1F * tall * u, tall, bend + 0.1F * tall * v)},
                       std::array{radius, 0.4F * radius}, 3));
    }
  }
  return mesh;
}

/// Adds a brush: an oval head that tapers into a handle along x, bristles upwards.
void add_brush(Scene& scene, const Materials& is, const Detail& detail, const glm::mat4& at, float size,
               std::uint32_t wood) {
  Mesh body = warped(
      make_cushion("brush", {-0.5F, -0.09F, -0.13F}, {0.5F, 0.0F, 0.13F}, 0.044F, detail.cells(4), detail.cells(6)),
      [](const glm::vec3& p) {
        const float along = std::min(std::max((p.x - 0.0F) / 0.25F, 0.0F), 1.0F);
        const float narrow = 1 - 0.62F * along * along * (3 - 2 * along);
        return glm::vec3(p.x, p.y, p.z * narrow);
      });
  const glm::mat4 scaled = at * placed(glm::vec3(0), 0, glm::vec3(size));
  add_object(scene, transformed(std::move(body), scaled), wood);
  Mesh bristles = make_bristles("bristles", 0.22F, 0.105F, 0.13F, 0.0035F, detail.cells(36, 8), detail.cells(18, 4));
  add_object(scene, transformed(std::move(bristles), scaled * placed({-0.24F, -0.002F, 0})), is.bristle);
}

void add_toothbrushes(Scene& scene, const Materials& is, const Detail& detail, const glm::vec3& at) {
  const glm::vec2 tumbler[] = {{0.03F, 0}, {0.036F, 0.1F}, {0.0345F, 0.1F}, {0.0285F, 0.008F}, {0, 0.008F}};
  add_object(scene, transformed(make_lathe("tumbler", detail.profile(tumbler), detail.cells(36, 12)), placed(at)),
             is.white);
  const std::uint32_t inks[] = {is.blue, is.rose, is.green};
  for (std::uint32_t k = 0; k < 3; ++k) {
    const glm::mat4 lean =
        placed(at + glm::vec3(0, 0.012F, 0), 0.33 * k) * turned(glm::vec3(-0.018F, 0, 0), {0, 0, 1}, -0.045);
    const glm::vec3 stick[] = {{0, 0, 0}, {0.001F, 0.06F, 0}, {0.001F, 0.12F, 0}, {0, 0.15F, 0}, {0, 0.18F, 0}};
    const float radii[] = {0.0045F, 0.0055F, 0.004F, 0.0035F, 0.005F};
    add_object(scene, transformed(make_tube("toothbrush", stick, radii, detail.cells(8, 4)), lean), inks[k]);
    const Mesh tufts =
        make_bristles("toothbrush bristles", 0.013F, 0.0055F, 0.011F, 0.0006F, detail.cells(14, 4), detail.cells(7, 3));
    add_object(scene, transformed(tufts, lean * turned({0.0035F, 0.168F, 0}, {0, 0, 1}, -0.25)), is.bristle);
  }
}

void add_duck(Scene& scene, const Materials& is, const Detail& detail, const glm::mat4& at) {
  const std::uint32_t cells = detail.cells(10, 4);
  Mesh duck = warped(make_sphere("rubber duck", glm::vec3(0), 1, cells), [](const glm::vec3& p) {
    const float tail = std::max(0.0F, -p.x);
    return glm::vec3(0.06F * p.x, 0.036F + 0.038F * p.y + 0.035F * tail * tail * tail,
                     0.042F * p.z * (1 - 0.35F * tail));
  });
  append(duck, make_sphere("", {0.035F, 0.092F, 0}, 0.031F, cells));
  for (const float side : {-1.0F, 1.0F}) {
    append(duck, transformed(warped(make_sphere("", glm::vec3(0), 1, detail.cells(6, 3)),
                                    [](const glm::vec3& p) {
                                      return glm::vec3(0.03F * p.x, 0.017F * p.y + 0.01F * p.x * p.x, 0.007F * p.z);
                                    }),
                             placed({-0.008F, 0.045F, side * 0.04F})));
  }
  duck.uvs.clear();
  add_object(scene, transformed(std::move(duck), at), is.duck);
  Mesh beak = warped(make_sphere("beak", glm::vec3(0), 1, detail.cells(5, 3)), [](const glm::vec3& p) {
    return glm::vec3(0.07F + 0.014F * p.x, 0.088F + 0.005F * p.y, 0.013F * p.z);
  });
  add_object(scene, transformed(std::move(beak), at), is.beak);
  Mesh eyes = make_sphere("eyes", {0.061F, 0.102F, 0.014F}, 0.004F, detail.cells(3, 2));
  append(eyes, make_sphere("", {0.061F, 0.102F, -0.014F}, 0.004F, detail.cells(3, 2)));
  add_object(scene, transformed(std::move(eyes), at), is.black);
}

void add_fern(Scene& scene, const Materials& is, const Detail& detail, const glm::vec3& at) {
  const glm::vec2 pot[] = {{0.035F, 0},     {0.05F, 0.08F},   {0.055F, 0.08F}, {0.055F, 0.095F},
                           {0.05F, 0.095F}, {0.045F, 0.085F}, {0, 0.085F}};
  add_object(scene, transformed(make_lathe("pot", detail.profile(pot), detail.cells(28, 10)), placed(at)), is.white);
  Mesh fern;
  fern.name = "fern";
  const std::uint32_t fronds = detail.cells(20, 8);
  for (std::uint32_t k = 0; k < fronds; ++k) {
    const glm::vec2 way = on_circle(static_cast<double>(0.382F * static_cast<float>(k)));
    const float rise = random_between(0.35F, 1.3F, 61, k), reach = random_between(0.16F, 0.24F, 62, k);
    const glm::vec3 direction = glm::normalize(glm::vec3(way.x, rise, way.y)), across(-way.y, 0, way.x);
    const auto on_rib = [&](float t) {
      return at + glm::vec3(0, 0.085F, 0) + reach * (t * direction - glm::vec3(0, 0.75F * t * t, 0));
    };
    const std::uint32_t leaflets = detail.cells(11, 5);
    for (std::uint32_t j = 1; j <= leaflets; ++j) {
      const float t = static_cast<float>(j) / static_cast<float>(leaflets);
      for (const float side : {-1.0F, 1.0F}) {
        add_leaf(fern, on_rib(t), glm::normalize(side * across + 0.5F * glm::vec3(way.x, 0.2F, way.y)),
                 0.06F * (1.1F - t), 0.011F, 0.3F, detail.cells(3, 2));
      }
    }
    const glm::vec3 rib[] = {on_rib(0), on_rib(0.33F), on_rib(0.66F), on_rib(1)};
    append(fern, make_tube("", rib, std::array{0.0015F}, 3));
  }
  add_object(scene, std::move(fern), is.leaf);
}

}  // namespace

void add_toiletries(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float back = -kHalfWidth;
  add_dispenser(scene, is, detail, {0.66F, kCounter, back + 0.34F});
  add_toothbrushes(scene, is, detail, {1.4F, kCounter, back + 0.22F});
  add_bottle(scene, detail, {1.56F, kCounter, back + 0.17F}, 0.032F, 0.2F, is.bottle, is.green);
  add_bottle(scene, detail, {1.63F, kCounter, back + 0.3F}, 0.026F, 0.13F, is.water, is.chrome);
  add_bottle(scene, detail, {1.53F, kCounter, back + 0.38F}, 0.02F, 0.09F, is.rose, is.white);
  add_fern(scene, is, detail, {0.46F, kCounter, back + 0.18F});
  add_brush(scene, is, detail, placed({0.52F, kCounter + 0.022F, back + 0.45F}, 0.06), 0.22F, is.oak);
  // In the caddy above the tub, and on the tub's rim.
  const float y = 1.256F, z = back + 0.075F;
  add_bottle(scene, detail, {-1.41F, y, z}, 0.033F, 0.2F, is.blue, is.white);
  add_bottle(scene, detail, {-1.32F, y, z}, 0.03F, 0.17F, is.bottle, is.rose);
  add_bottle(scene, detail, {-1.24F, y, z}, 0.028F, 0.21F, is.green, is.white);
  add_duck(scene, is, detail, placed({-0.28F, kTubRim + 0.004F, kTubZ + 0.362F}, 0.11));
  add_brush(scene, is, detail, placed({-0.055F, kTubRim + 0.04F, kTubZ - 0.05F}, 0.24), 0.34F, is.oak);
  Mesh soap = make_cushion("soap", {-0.04F, 0, -0.026F}, {0.04F, 0.026F, 0.026F}, 0.0125F, detail.cells(4), 1);
  add_object(scene, transformed(std::move(soap), placed({0.72F, kCounter, back + 0.47F}, 0.07)), is.rose);
  // A rack across the tub with a sponge.
  Mesh rack;
  rack.name = "bath rack";
  for (int k = 0; k < 5; ++k) {
    const float x = -0.86F + 0.035F * static_cast<float>(k);
    append(rack, make_rounded_box("", {x, kTubRim + 0.004F, kTubZ - 0.4F}, {x + 0.024F, kTubRim + 0.02F, kTubZ + 0.4F},
                                  0.004F, detail.cells(2)));
  }
  for (const float at : {-0.3F, 0.3F})
    append(rack, make_box("", {-0.86F, kTubRim + 0.0F, kTubZ + at - 0.015F},
                          {-0.696F, kTubRim + 0.006F, kTubZ + at + 0.015F}));
  project_uvs(rack, 1.5F);
  add_object(scene, std::move(rack), is.oak);
  Mesh sponge = warped(
      make_cushion("sponge", {-0.06F, 0, -0.045F}, {0.06F, 0.05F, 0.045F}, 0.02F, detail.cells(4), detail.cells(10)),
      [](const glm::vec3& p) { return p * (1 + 0.16F * (fractal(60.0F * p + glm::vec3(9), 2, 5) - 0.5F)); });
  add_object(scene, transformed(std::move(sponge), placed({-0.78F, kTubRim + 0.02F, kTubZ + 0.08F}, 0.1)), is.duck);
}

}  // namespace traces::bathroom
