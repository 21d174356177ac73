#include <algorithm>
#include <array>
#include <vector>

#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::bathroom {
namespace {

/// Makes a swan-necked tap at the origin, its spout towards +z.
Mesh make_tap(const Detail& detail, float height, float reach) {
  const std::uint32_t round = detail.cells(16, 6);
  const glm::vec2 foot[] = {{0.028F, 0},     {0.028F, 0.008F}, {0.02F, 0.014F},
                            {0.017F, 0.05F}, {0.013F, 0.055F}, {0, 0.055F}};
  Mesh mesh = make_lathe("tap", detail.profile(foot), round);
  const glm::vec3 neck[] = {{0, 0.03F, 0},
                            {0, 0.7F * height, 0.0F},
                            {0, height, 0.35F * reach},
                            {0, 0.95F * height, 0.85F * reach},
                            {0, 0.72F * height, reach}};
  append(mesh, make_tube("", smoothed(neck, detail.cells(8, 3)), std::array{0.0105F}, round));
  for (const float side : {-1.0F, 1.0F}) {
    const glm::mat4 at = placed({side * 0.085F, 0, 0});
    const glm::vec2 knob[] = {{0.022F, 0},      {0.022F, 0.006F}, {0.012F, 0.012F}, {0.012F, 0.04F},
                              {0.018F, 0.046F}, {0.016F, 0.056F}, {0, 0.058F}};
    append(mesh, transformed(make_lathe("", detail.profile(knob), round), at));
    for (int k = 0; k < 4; ++k) {
      const glm::vec2 way = on_circle(0.25 * k + 0.1);
      const glm::vec3 spoke[] = {{0, 0.05F, 0}, {0.034F * way.x, 0.05F, 0.034F * way.y}};
      append(mesh, transformed(make_tube("", spoke, std::array{0.005F}, detail.cells(8, 4)), at));
      append(mesh,
             transformed(make_sphere("", {0.036F * way.x, 0.05F, 0.036F * way.y}, 0.007F, detail.cells(3, 2)), at));
    }
  }
  return mesh;
}

Mesh make_drain(const Detail& detail) {
  const glm::vec2 plug[] = {{0.03F, 0}, {0.03F, 0.003F}, {0.022F, 0.004F}, {0.018F, 0.009F}, {0, 0.011F}};
  return make_lathe("drain", detail.profile(plug), detail.cells(20, 8));
}

}  // namespace

Mesh make_vessel(std::string name, std::span<const glm::vec3> rings, bool square, std::uint32_t round,
                 std::uint32_t steps) {
  const std::vector<glm::vec3> path = smoothed(rings, steps);
  const auto last = static_cast<std::uint32_t>(path.size() - 1);
  return make_surface(
      std::move(name), round, last,
      [&](float s, float t) {
        const glm::vec3 ring = path[static_cast<std::size_t>(t * static_cast<float>(last) + 0.5F)];
        const float a = std::max(ring.x, 0.0F), b = std::max(ring.y, 0.0F);
        const glm::vec2 p = square ? on_rounded_rectangle(static_cast<double>(s), a, b)
                                   : on_circle(static_cast<double>(s)) * glm::vec2(a, b);
        return glm::vec3(p.x, ring.z, -p.y);
      },
      true);
}

void add_tub(Scene& scene, const Materials& is, const Detail& detail) {
  const glm::vec3 rings[] = {{0.80F, 0.34F, 0.0F},     {0.81F, 0.345F, 0.04F}, {0.835F, 0.37F, 0.30F},
                             {0.85F, 0.388F, 0.53F},   {0.86F, 0.40F, 0.555F}, {0.86F, 0.40F, 0.575F},
                             {0.845F, 0.385F, 0.585F}, {0.80F, 0.335F, 0.58F}, {0.785F, 0.32F, 0.565F},
                             {0.76F, 0.305F, 0.48F},   {0.70F, 0.27F, 0.22F},  {0.66F, 0.235F, 0.14F},
                             {0.56F, 0.16F, 0.11F},    {0.3F, 0.08F, 0.1F},    {0, 0, 0.098F}};
  const glm::vec3 middle(kTubLeft + kTubHalf, 0, kTubZ);
  add_object(scene,
             transformed(make_vessel("bath tub", rings, true, detail.cells(112, 24), detail.cells(4)), placed(middle)),
             is.enamel);
  add_object(scene, transformed(make_drain(detail), placed(middle + glm::vec3(-0.45F, 0.108F, 0))), is.chrome);
  add_object(scene, transformed(make_tap(detail, 0.2F, 0.2F), placed({kTubLeft + 0.035F, kTubRim, kTubZ}, 0.25)),
             is.chrome);
  // A glass screen on the rim, hinged at the wall.
  const float z = kTubZ + 0.36F;
  // One sheet without refraction: through two glass surfaces, paths of limited depth would not reach the chrome.
  add_object(scene, make_quad("shower screen", {-1.77F, kTubRim + 0.012F, z}, {0.82F, 0, 0}, {0, 1.4F, 0}, 1),
             is.glass);
  Mesh profile = make_box("screen profile", {-1.79F, kTubRim + 0.01F, z - 0.012F}, {-1.765F, 2.01F, z + 0.012F});
  append(profile, make_box("", {-1.765F, kTubRim + 0.004F, z - 0.007F}, {-0.95F, kTubRim + 0.014F, z + 0.007F}));
  append(profile, make_box("", {-1.765F, 2.0F, z - 0.007F}, {-0.95F, 2.012F, z + 0.007F}));
  append(profile, make_box("", {-0.955F, kTubRim + 0.004F, z - 0.006F}, {-0.945F, 2.012F, z + 0.006F}));
  add_object(scene, std::move(profile), is.chrome);
}

void add_vanity(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float kLeft = 0.32F, kRight = 1.72F, kFront = -kHalfWidth + 0.5F, back = -kHalfWidth + 0.012F;
  Mesh cabinet = make_box("vanity", {kLeft, 0.25F, back}, {kRight, kCounter - 0.04F, kFront});
  const glm::vec2 drawer[] = {{0.004F, 0}, {0.004F, 0.018F}, {0.012F, 0.022F}, {0.05F, 0.022F}, {0.055F, 0.015F}};
  Mesh pulls;
  pulls.name = "drawer pulls";
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < 2; ++k) {
      const glm::vec3 corner(kLeft + 0.7F * static_cast<float>(k), 0.25F + 0.275F * static_cast<float>(row), kFront);
      append(cabinet,
             transformed(make_panel("", 0.7F, 0.275F, detail.profile(drawer), detail.cells(3)), placed(corner)));
      const glm::vec3 bow[] = {corner + glm::vec3(0.27F, 0.14F, 0.012F), corner + glm::vec3(0.275F, 0.14F, 0.035F),
                               corner + glm::vec3(0.35F, 0.14F, 0.045F), corner + glm::vec3(0.425F, 0.14F, 0.035F),
                               corner + glm::vec3(0.43F, 0.14F, 0.012F)};
      append(pulls, make_tube("", smoothed(bow, detail.cells(4, 2)), std::array{0.005F}, detail.cells(8, 4)));
    }
  }
  for (const float x : {kLeft + 0.05F, kRight - 0.05F}) {
    for (const float z : {back + 0.05F, kFront - 0.05F}) {
      append(cabinet, transformed(make_cone("", 0.018F, 0.03F, 0.25F, detail.cells(16, 6)), placed({x, 0, z})));
    }
  }
  project_uvs(cabinet, 0.8F);
  add_object(scene, std::move(cabinet), is.oak);
  add_object(scene, std::move(pulls), is.chrome);
  Mesh top = make_rounded_box("counter", {kLeft - 0.03F, kCounter - 0.04F, back},
                              {kRight + 0.03F, kCounter, kFront + 0.04F}, 0.008F, detail.cells(3));
  project_uvs(top, 0.9F);
  add_object(scene, std::move(top), is.stone);
}

void add_basin(Scene& scene, const Materials& is, const Detail& detail) {
  const glm::vec3 rings[] = {
      {0.15F, 0.11F, 0},        {0.19F, 0.14F, 0.03F},   {0.245F, 0.178F, 0.11F}, {0.255F, 0.187F, 0.135F},
      {0.252F, 0.184F, 0.142F}, {0.242F, 0.175F, 0.14F}, {0.23F, 0.163F, 0.115F}, {0.18F, 0.125F, 0.04F},
      {0.1F, 0.07F, 0.018F},    {0.04F, 0.03F, 0.014F},  {0, 0, 0.013F}};
  const glm::vec3 at(1.02F, kCounter, -kHalfWidth + 0.29F);
  add_object(scene,
             transformed(make_vessel("wash basin", rings, false, detail.cells(72, 20), detail.cells(4)), placed(at)),
             is.enamel);
  add_object(scene, transformed(make_drain(detail), placed(at + glm::vec3(0, 0.013F, 0))), is.chrome);
  add_object(scene, transformed(make_tap(detail, 0.28F, 0.17F), placed({1.02F, kCounter, -kHalfWidth + 0.075F})),
             is.chrome);
}

/// Adds the mirror above the basin, and a row of bulbs above it.
void add_mirror(Scene& scene, const Materials& is, const Detail& detail) {
  const glm::mat4 wall = standing({-kHalfLength, 0, -kHalfWidth}, {0, 0, 1});
  const glm::vec2 rim[] = {{0, 0}, {0, 0.03F}, {0.02F, 0.035F}, {0.03F, 0.02F}, {0.03F, 0.018F}};
  Mesh frame = make_panel("mirror frame", 1.4F, 0.9F, rim);
  frame.triangles.resize(frame.triangles.size() - 2);
  add_object(scene, transformed(std::move(frame), wall * placed({2.12F, 1.2F, 0})), is.oak);
  add_object(scene, transformed(make_quad("mirror", {2.15F, 1.23F, 0.019F}, {1.34F, 0, 0}, {0, 0.84F, 0}, 1), wall),
             is.mirror);
  Mesh bulbs,
      sockets = transformed(
          make_rounded_box("lamp strip", {2.3F, 2.15F, 0}, {3.34F, 2.21F, 0.03F}, 0.01F, detail.cells(2)), wall);
  bulbs.name = "bulbs";
  for (int k = 0; k < 6; ++k) {
    const float x = 2.4F + 0.168F * static_cast<float>(k);
    append(bulbs, transformed(make_sphere("", {x, 2.18F, 0.085F}, 0.034F, detail.cells(6, 3)), wall));
    append(sockets, transformed(make_cylinder("", 0.02F, 0.035F, detail.cells(14, 6)),
                                wall * turned({x, 2.18F, 0.025F}, {1, 0, 0}, 0.25)));
  }
  add_object(scene, std::move(bulbs), is.lamp);
  add_object(scene, std::move(sockets), is.chrome);
}

void add_toilet(Scene& scene, const Materials& is, const Detail& detail) {
  const std::uint32_t round = detail.cells(64, 18), steps = detail.cells(4);
  const glm::vec3 bowl[] = {
      {0.12F, 0.10F, 0},      {0.115F, 0.095F, 0.04F}, {0.11F, 0.09F, 0.14F},  {0.17F, 0.14F, 0.25F},
      {0.235F, 0.18F, 0.37F}, {0.24F, 0.185F, 0.395F}, {0.235F, 0.18F, 0.40F}, {0.19F, 0.14F, 0.398F},
      {0.15F, 0.11F, 0.3F},   {0.06F, 0.05F, 0.18F},   {0, 0, 0.17F}};
  const glm::vec3 lid[] = {{0.225F, 0.175F, 0.41F}, {0.245F, 0.188F, 0.415F}, {0.247F, 0.19F, 0.43F},
                           {0.235F, 0.18F, 0.442F}, {0.12F, 0.1F, 0.448F},    {0, 0, 0.45F}};
  // Its length becomes x; the front is elongated.
  const auto egg = [](const glm::vec3& p) {
    return glm::vec3(p.x < 0 ? 1.15F * p.x : p.x, p.y, p.z * (1 - 0.25F * p.x / 0.25F * 0.3F));
  };
  const glm::mat4 at = placed({kHalfLength - 0.46F, 0, 0.1F});
  Mesh body = warped(make_vessel("toilet", bowl, false, round, steps), egg);
  append(body, warped(make_vessel("", lid, false, round, steps), egg));
  append(body, make_cushion("", {0.2F, 0.36F, -0.19F}, {0.44F, 0.78F, 0.19F}, 0.03F, detail.cells(4), 1));
  append(body, make_cushion("", {0.19F, 0.785F, -0.2F}, {0.445F, 0.82F, 0.2F}, 0.015F, detail.cells(3), 1));
  append(body, make_cushion("", {0.05F, 0.0F, -0.1F}, {0.40F, 0.37F, 0.1F}, 0.03F, detail.cells(3), 1));
  add_object(scene, transformed(std::move(body), at), is.enamel);
  const glm::vec2 button[] = {{0.025F, 0}, {0.025F, 0.004F}, {0.02F, 0.006F}, {0, 0.006F}};
  add_object(
      scene,
      transformed(make_lathe("flush", detail.profile(button), detail.cells(16, 6)), at * placed({0.32F, 0.82F, 0})),
      is.chrome);
  // A roll of paper on its holder.
  const glm::vec3 holder[] = {{kHalfLength - 0.01F, 0.78F, 0.5F},
                              {kHalfLength - 0.06F, 0.78F, 0.5F},
                              {kHalfLength - 0.09F, 0.78F, 0.54F},
                              {kHalfLength - 0.09F, 0.78F, 0.64F}};
  add_object(scene,
             make_tube("paper holder", smoothed(holder, detail.cells(4, 2)), std::array{0.006F}, detail.cells(10, 5)),
             is.chrome);
  const glm::vec2 roll[] = {{0.02F, 0}, {0.055F, 0}, {0.055F, 0.1F}, {0.02F, 0.1F}, {0.02F, 0}};
  add_object(scene,
             transformed(make_lathe("paper roll", detail.profile(roll), detail.cells(36, 12)),
                         turned({kHalfLength - 0.09F, 0.768F, 0.52F}, {1, 0, 0}, 0.25)),
             is.white);
}

}  // namespace traces::bathroom
