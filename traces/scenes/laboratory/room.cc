#include "traces/scenes/laboratory/room.h"

#include <utility>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/turned.h"

namespace traces::laboratory {
namespace {

constexpr float kFloor = -0.9F, kCeiling = 1.6F, kLeft = -1.35F, kRight = 1.45F, kBack = -0.52F, kFront = 1.9F;

void add_cupboards(Scene& scene, const Looks& looks, const Detail& detail) {
  const std::uint32_t white = looks.lacquer, steel = looks.steel;
  const std::uint32_t steps = detail.cells(2);
  const std::uint32_t door =
      add_mesh(scene, make_rounded_box("door", {-0.205F, -0.78F, 0}, {0.205F, -0.23F, 0.025F}, 0.008F, steps), white);
  const std::uint32_t drawer = add_mesh(
      scene, make_rounded_box("drawer", {-0.205F, -0.215F, 0}, {0.205F, -0.055F, 0.025F}, 0.008F, steps), white);
  const std::uint32_t handle = add_mesh(
      scene, make_rounded_box("handle", {-0.06F, -0.14F, 0.03F}, {0.06F, -0.125F, 0.05F}, 0.006F, steps), steel);
  for (int k = 0; k < 6; ++k) {
    const glm::mat4 at = placed({kLeft + 0.225F + 0.42F * static_cast<float>(k), 0, 0.27F});
    for (const std::uint32_t mesh : {door, drawer, handle}) add_instance(scene, mesh, at);
  }
  add_object(scene, make_box("cupboards", {kLeft, -0.8F, kBack}, {1.2F, -0.045F, 0.27F}), white);
}

void add_shelves(Scene& scene, std::uint32_t board, const Detail& detail) {
  const std::uint32_t steps = detail.cells(3);
  for (const float height : {kShelf, kUpperShelf}) {
    add_object(
        scene,
        make_rounded_box("shelf", {kShelfFrom, height - 0.022F, kBack}, {kShelfTo, height, -0.34F}, 0.005F, steps),
        board);
  }
  for (const float x : {kShelfFrom - 0.02F, kShelfTo}) {
    add_object(scene,
               make_rounded_box("shelf side", {x, kShelf - 0.05F, kBack}, {x + 0.02F, kUpperShelf + 0.2F, -0.335F},
                                0.005F, steps),
               board);
  }
}

}  // namespace

void add_room(Scene& scene, const Looks& looks, const Detail& detail) {
  const glm::vec3 x(kRight - kLeft, 0, 0), y(0, kCeiling - kFloor, 0), z(0, 0, kFront - kBack);
  const glm::vec3 low(kLeft, kFloor, kBack), high(kRight, kCeiling, kFront);
  Mesh back = make_quad("back wall", low, x, y, detail.cells(12, 2));
  scale_uvs(back, {2.24F, 2});
  add_object(scene, std::move(back), looks.tiles);
  add_object(scene, make_quad("floor", low, z, x, 2, 1.6F), looks.floor);
  add_object(scene, make_quad("left wall", low, y, z, 2), looks.plaster);
  add_object(scene, make_quad("right wall", high, -y, -z, 2), looks.plaster);
  add_object(scene, make_quad("front wall", high, -x, -y, 2), looks.plaster);
  add_object(scene, make_quad("ceiling", high, -z, -x, 2), looks.plaster);

  Mesh top = make_rounded_box("bench top", {kLeft, -0.04F, kBack}, {1.22F, 0, 0.32F}, 0.008F, detail.cells(3));
  for (std::size_t k = 0; k < top.uvs.size(); ++k)
    top.uvs[k] = {1.1F * top.positions[k].x, 1.1F * (top.positions[k].z + top.positions[k].y)};
  add_object(scene, std::move(top), looks.bench);
  add_cupboards(scene, looks, detail);
  add_shelves(scene, looks.shelf, detail);
  add_object(scene, make_quad("chart", {-0.80F, 0.21F, kBack + 0.004F}, {0.72F, 0, 0}, {0, 0.40F, 0}, 1), looks.chart);
  for (glm::vec2& uv : scene.meshes.back().uvs) uv.y = 1 - uv.y;
  add_object(scene, make_box("chart rail", {-0.81F, 0.61F, kBack}, {-0.07F, 0.622F, kBack + 0.012F}), looks.rail);

  // The window's panes, in front of their frame, light the room; so does, weakly, a lamp at the ceiling.
  Mesh panes;
  for (int column = 0; column < 2; ++column) {
    for (int row = 0; row < 2; ++row) {
      const glm::vec3 corner(kLeft + 0.03F, 0.35F + 0.52F * static_cast<float>(row),
                             0.15F + 0.52F * static_cast<float>(column));
      append(panes, make_quad("", corner, {0, 0.48F, 0}, {0, 0, 0.48F}, 1));
    }
  }
  panes.name = "window";
  add_object(scene, std::move(panes), looks.daylight);
  add_object(scene, make_box("window frame", {kLeft, 0.30F, 0.10F}, {kLeft + 0.02F, 1.40F, 1.20F}), looks.plaster);
  add_object(scene, make_quad("ceiling lamp", {-0.1F, kCeiling - 0.01F, 0.5F}, {0.9F, 0, 0}, {0, 0, 0.3F}, 1),
             looks.lamp);
}

}  // namespace traces::laboratory
