#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/laboratory/apparatus.h"
#include "traces/scenes/laboratory/glassware.h"
#include "traces/scenes/laboratory/room.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/modelling/turned.h"

namespace traces {
namespace {

using laboratory::Looks;
using laboratory::Vessel;

constexpr float kSeconds = 8;

/// Places vessels with their fillings; equal vessels share a mesh.
class Glassware {
 public:
  Glassware(Scene& scene, std::uint32_t glass, const Detail& detail) : scene_(scene), glass_(glass), detail_(detail) {}

  void place(Vessel vessel, const glm::vec3& at, float height, std::uint32_t filling, double turns = 0) {
    std::uint32_t& mesh = meshes_[static_cast<std::size_t>(vessel)];
    if (mesh == kNone) mesh = add_mesh(scene_, laboratory::make_vessel(vessel, detail_), glass_);
    add_instance(scene_, mesh, placed(at, turns));
    if (height > 0)
      add_instance(scene_, add_mesh(scene_, laboratory::make_filling(vessel, height, detail_), filling), placed(at));
  }

  void add(Mesh mesh, const glm::vec3& at) {
    add_instance(scene_, add_mesh(scene_, std::move(mesh), glass_), placed(at));
  }

 private:
  Scene& scene_;
  std::uint32_t glass_;
  Detail detail_;
  std::array<std::uint32_t, 9> meshes_{kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
};

/// Adds two rows of bottles with labels and stoppers.
void add_bottles(Scene& scene, const Looks& looks, const Detail& detail) {
  std::array<std::uint32_t, 4> bottles{};
  for (std::size_t k = 0; k < bottles.size(); ++k) {
    bottles[k] = add_mesh(scene, laboratory::make_filling(Vessel::kBottle, 0.125F, Detail{0.8 * detail.share}),
                          looks.bottles[k]);
  }
  const std::uint32_t label =
      add_mesh(scene,
               make_surface("label", detail.cells(10, 4), 1,
                            [](float s, float t) {
                              const glm::vec2 way = on_circle(0.25 - 0.17 + 0.34 * static_cast<double>(1 - s));
                              return glm::vec3(0.0335F * way.x, 0.03F + 0.04F * t, 0.0335F * way.y);
                            }),
               looks.label);
  for (glm::vec2& uv : scene.meshes.back().uvs) uv.y = 1 - uv.y;
  Outline stopper({0, 0.118F});
  stopper.line(0.013F, 0.118F).line(0.014F, 0.128F).line(0.019F, 0.131F).arc(0.016F, 0.146F, 0.003F).line(0, 0.148F);
  const std::uint32_t top =
      add_mesh(scene, make_lathe("stopper", simplified(stopper.points(), detail.cells(9, 6)), detail.cells(20, 7)),
               looks.stopper);
  for (const float height : {laboratory::kShelf, laboratory::kUpperShelf}) {
    const bool is_upper = height > laboratory::kShelf;
    const std::uint64_t row = is_upper ? 1 : 0;
    for (std::uint64_t k = 0; k < 10; ++k) {
      if (random(k, row, 82) < 0.12F) continue;
      const float x = laboratory::kShelfFrom + 0.055F + 0.094F * static_cast<float>(k) +
                      random_between(-0.006F, 0.006F, k, row, 83);
      const glm::vec3 at(x, height, laboratory::kShelfDepth + random_between(-0.015F, 0.02F, k, row, 84));
      const glm::mat4 to_world = placed(at, static_cast<double>(random_between(-0.06F, 0.06F, k, row, 85)),
                                        glm::vec3(random_between(0.92F, 1.1F, k, row, 86)));
      add_instance(scene, bottles[static_cast<std::size_t>(4 * random(k, row, 87))], to_world);
      add_instance(scene, label, to_world);
      add_instance(scene, top, to_world);
    }
  }
}

/// Adds the burette's tap, its falling drops, and the stirring bar in the flask.
void add_titration(Scene& scene, const Looks& looks, const glm::vec3& flask, float tip, std::uint32_t drop_stuff,
                   const Detail& detail) {
  Mesh tap = make_cylinder("burette tap", 0.008F, 0.03F, detail.cells(16, 6));
  for (glm::vec3& p : tap.positions) p = {p.y - 0.015F, -p.x, p.z};
  for (glm::vec3& n : tap.normals) n = {n.y, -n.x, n.z};
  append(tap, make_rounded_box("", {0.015F, -0.014F, -0.003F}, {0.021F, 0.014F, 0.003F}, 0.002F, detail.cells(2)));
  add_instance(scene, add_mesh(scene, std::move(tap), looks.plastic), placed({flask.x, tip + 0.038F, flask.z}));

  const Outline drop = Outline({0, -0.003F}).round({0, 0}, 0.003F, -0.25, 0.12).line(0, 0.0065F);
  const std::uint32_t drop_mesh = add_mesh(
      scene, make_lathe("drop", simplified(drop.points(), detail.cells(10, 5)), detail.cells(14, 6)), drop_stuff);
  const std::uint32_t node = add_node(scene, "drop", {.translation = {flask.x, tip, flask.z}});
  hang(scene, add_instance(scene, drop_mesh), node);
  std::vector<Key> keys;
  constexpr float kPeriod = 2, kFall = 0.3F;
  for (float start = 0; start < kSeconds; start += kPeriod) {
    for (int k = 0; k <= 6; ++k) {
      const float t = static_cast<float>(k) / 6;
      keys.push_back({start + kPeriod - 0.4F + kFall * t, {flask.x, tip - (tip - flask.y - 0.03F) * t * t, flask.z}});
    }
    keys.push_back({start + kPeriod - 0.09F, {flask.x, tip + 0.02F, flask.z}});  // the next drop forms in the tip
    keys.push_back({start + kPeriod, {flask.x, tip, flask.z}});
  }
  move_node(scene, node, keys);

  const std::array path{glm::vec3(-0.014F, 0, 0), glm::vec3(-0.012F, 0, 0), glm::vec3(0.012F, 0, 0),
                        glm::vec3(0.014F, 0, 0)};
  const std::array radii{0.001F, 0.003F, 0.003F, 0.001F};
  const std::uint32_t bar =
      add_mesh(scene, make_tube("stirring bar", path, radii, detail.cells(12, 5)), looks.porcelain);
  const std::uint32_t spin = add_node(scene, "stirring bar", {.translation = flask + glm::vec3(0, 0.009F, 0)});
  hang(scene, add_instance(scene, bar), spin);
  std::vector<TurnKey> turns;
  for (int k = 0; k <= 96; ++k) turns.push_back({kSeconds * static_cast<float>(k) / 96, rotation({0, 1, 0}, 0.25 * k)});
  turn_node(scene, spin, turns);
}

void add_all(Scene& scene, const Looks& looks, const Detail& detail) {
  laboratory::add_room(scene, looks, detail);
  Glassware ware(scene, looks.glass, detail);

  // Left: a flask over the burner.
  const glm::vec3 burner(-0.50F, 0, -0.13F);
  laboratory::add_burner(scene, looks, burner, detail);
  laboratory::add_stand(scene, looks, burner + glm::vec3(-0.17F, 0, -0.06F), -0.054, 0.338F, 0.18F, detail);
  ware.place(Vessel::kRound, burner + glm::vec3(0, 0.204F, 0), 0.055F, looks.orange);

  const glm::vec3 rack(-0.20F, 0, 0.07F);
  laboratory::add_rack(scene, looks, rack, detail);
  const std::uint32_t tubes[] = {looks.red, looks.orange, looks.yellow, looks.green, looks.blue, looks.violet};
  for (int k = 0; k < 6; ++k) {
    const float height = 0.05F + 0.05F * random(static_cast<std::uint64_t>(k), 91);
    ware.place(Vessel::kTestTube, rack + glm::vec3(-0.10F + 0.04F * static_cast<float>(k), 0.0185F, 0), height,
               tubes[k]);
  }

  // The middle: a titration.
  const glm::vec3 stirrer(0.17F, 0, -0.08F), flask = stirrer + glm::vec3(0, 0.0555F, 0);
  constexpr float kTip = 0.215F;
  laboratory::add_stirrer(scene, looks, stirrer, detail);
  laboratory::add_stand(scene, looks, stirrer + glm::vec3(-0.05F, 0, -0.17F), -0.205, 0.46F, 0.177F, detail);
  ware.place(Vessel::kErlenmeyer, flask, 0.045F, looks.pink);
  ware.place(Vessel::kBurette, {flask.x, kTip, flask.z}, 0.31F, looks.water);
  add_titration(scene, looks, flask, kTip, looks.water, detail);

  // The rest of the bench.
  ware.place(Vessel::kBeaker, {0.03F, 0, 0.13F}, 0.062F, looks.blue, 0.4);
  ware.place(Vessel::kBeaker, {-0.03F, 0, -0.20F}, 0.045F, looks.yellow, 0.1);
  ware.place(Vessel::kErlenmeyer, {0.375F, 0, 0.05F}, 0.065F, looks.green);
  ware.place(Vessel::kErlenmeyer, {0.63F, 0, -0.16F}, 0.05F, looks.yellow);
  ware.place(Vessel::kVolumetric, {0.50F, 0, -0.06F}, 0.10F, looks.violet);
  ware.place(Vessel::kCylinder, {0.34F, 0.008F, -0.20F}, 0.13F, looks.red);
  ware.place(Vessel::kCylinder, {0.44F, 0.008F, -0.26F}, 0.16F, looks.blue);
  const Outline foot = Outline({0, 0}).line(0.032F, 0).line(0.032F, 0.004F).line(0.018F, 0.0065F).line(0, 0.0065F);
  ware.add(make_lathe("cylinder foot", foot.points(), detail.cells(30, 8)), {0.34F, 0, -0.20F});
  ware.add(make_lathe("cylinder foot", foot.points(), detail.cells(30, 8)), {0.44F, 0, -0.26F});
  const glm::vec3 ring(0.62F, 0, 0.09F);
  add_instance(
      scene,
      add_mesh(scene, make_torus("cork ring", 0.034F, 0.011F, detail.cells(30, 8), detail.cells(12, 5)), looks.cork),
      placed(ring + glm::vec3(0, 0.011F, 0)));
  ware.place(Vessel::kRound, ring + glm::vec3(0, 0.0105F, 0), 0.060F, looks.red);
  ware.place(Vessel::kDish, {0.20F, 0, 0.17F}, 0.007F, looks.green);
  ware.place(Vessel::kDish, {0.25F, 0, 0.08F}, 0, looks.green);
  ware.place(Vessel::kBeaker, {-0.36F, 0, -0.27F}, 0.07F, looks.water, 0.2);
  ware.place(Vessel::kErlenmeyer, {-0.72F, 0, 0.06F}, 0.055F, looks.blue);
  laboratory::add_mortar(scene, looks, {-0.44F, 0, 0.16F}, detail);
  laboratory::add_notebook(scene, looks, {0.44F, 0, 0.20F}, -0.04, detail);
  add_bottles(scene, looks, detail);
}

}  // namespace

/// A chemist's bench with nested glass: most rays are refracted.
Scene build_laboratory(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 98'000;
  const Detail detail = fit_detail(options.triangles_or(kClass), [](const Detail& at) {
    Scene shapes;
    add_all(shapes, {}, at);
    return triangles_of(shapes);
  });
  Scene scene;
  scene.name = "laboratory";
  scene.background = glm::vec3(0.3F);
  add_all(scene, laboratory::add_looks(scene), detail);
  scene.cameras.push_back(look_at("front", {0.10F, 0.38F, 1.08F}, {0.035F, 0.195F, -0.12F}, 0.60F));
  scene.cameras.push_back(look_at("burner", {-0.30F, 0.30F, 0.52F}, {-0.46F, 0.19F, -0.13F}, 0.65F));
  const ViewKey path[] = {{0, {-0.75F, 0.30F, 0.62F}, {-0.42F, 0.17F, -0.12F}},
                          {2, {-0.40F, 0.28F, 0.58F}, {-0.20F, 0.14F, -0.05F}},
                          {4, {0.05F, 0.30F, 0.55F}, {0.12F, 0.15F, -0.08F}},
                          {6, {0.50F, 0.32F, 0.58F}, {0.40F, 0.13F, -0.05F}},
                          {8, {0.85F, 0.45F, 0.85F}, {0.25F, 0.17F, -0.12F}}};
  add_camera_path(scene, "path", path, 0.7F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
