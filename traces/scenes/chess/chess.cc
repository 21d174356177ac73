#include <array>
#include <string_view>
#include <vector>

#include <glm/common.hpp>

#include "traces/scene/cameras.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/chess/pieces.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::chess {
namespace {

/// Height of the table's surface. The squares of the board are at 0.
constexpr float kTableTop = -0.42F;

constexpr float kFloor = -9, kCeiling = 14, kLeft = -15, kRight = 19, kBack = -17, kFront = 19;

/// Makes all light or all dark squares of the board. Each square shows a different part of the wood texture.
Mesh make_squares(bool light) {
  Mesh squares;
  for (int file = 0; file < 8; ++file) {
    for (int rank = 0; rank < 8; ++rank) {
      if (((file + rank) % 2 != 0) != light) continue;
      const glm::vec3 corner(static_cast<float>(file) - 4, 0, 3 - static_cast<float>(rank));
      Mesh square = make_quad("", corner, {0, 0, 1}, {1, 0, 0}, 1);
      const auto id = static_cast<std::uint64_t>(file * 8 + rank);
      const glm::vec2 from(random_unit(id, 1), random_unit(id, 2));
      for (glm::vec2& uv : square.uvs) uv = from + glm::vec2(0.22F, 0.16F) * uv;
      append_mesh(squares, square);
    }
  }
  squares.name = light ? "light squares" : "dark squares";
  return squares;
}

/// Makes the frame of the board: four planks with mitred corners, rounded outside, around the squares.
Mesh make_frame() {
  constexpr float kInner = 4, kOuter = 4.75F;
  const glm::vec2 shape[] = {{kInner, -0.02F},        {kInner, 0.03F},          {kInner + 0.08F, 0.05F},
                             {kOuter - 0.16F, 0.05F}, {kOuter - 0.05F, 0},      {kOuter, -0.10F},
                             {kOuter, -0.24F},        {kOuter + 0.08F, -0.30F}, {kOuter + 0.08F, kTableTop}};
  Mesh frame;
  for (int side = 0; side < 4; ++side) {
    Mesh board;
    for (std::size_t k = 0; k + 1 < std::size(shape); ++k) {
      const glm::vec2 a = shape[k], b = shape[k + 1];
      const glm::vec2 along = glm::normalize(b - a);
      const auto first = static_cast<std::uint32_t>(board.positions.size());
      for (const glm::vec2& p : {a, b}) {
        for (const float end : {-1.0F, 1.0F}) {
          board.positions.emplace_back(p.x, p.y, -end * p.x);
          board.normals.emplace_back(-along.y, along.x, 0);
          board.uvs.emplace_back(0.1F * end * p.x, 0.16F * (p.x + p.y) + 0.37F * static_cast<float>(side));
        }
      }
      // Rows of vertices run outwards, columns along the board towards -z.
      board.triangles.push_back({first, first + 3, first + 1});
      board.triangles.push_back({first, first + 2, first + 3});
    }
    append_mesh(frame, transform_mesh(board, placement_at({0, 0, 0}, 0.25 * side)));
  }
  frame.name = "frame of the board";
  return frame;
}

void add_clock(Scene& scene, const Detail& detail, std::uint32_t wood, std::uint32_t brass, std::uint32_t ivory,
               std::uint32_t black) {
  // The clock, which faces +z in its own space.
  const glm::mat4 at = placement_at({-6.9F, kTableTop, -0.6F}, 0.19);
  const auto part = [&](Mesh mesh, std::uint32_t material) {
    add_instance(scene, add_mesh(scene, std::move(mesh), material), at);
  };
  part(make_rounded_box("clock", {-1.35F, 0.06F, -0.36F}, {1.35F, 1.35F, 0.36F}, 0.1F, detail.cell_count(3)), wood);
  const glm::mat4 upright(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0), glm::vec4(0, 0, 0, 1));
  const std::uint32_t sides = detail.cell_count(32, 10);
  Mesh dials, rings, hands, buttons;
  for (const float x : {-0.62F, 0.62F}) {
    glm::mat4 dial_to_clock = upright;
    dial_to_clock[3] = glm::vec4(x, 0.71F, 0.36F, 1);
    append_mesh(dials, transform_mesh(make_cylinder("", 0.47F, 0.012F, sides), dial_to_clock));
    const glm::vec2 bezel[] = {{0.53F, 0}, {0.53F, 0.05F}, {0.50F, 0.07F}, {0.46F, 0.04F}, {0.46F, 0}};
    append_mesh(rings, transform_mesh(make_lathe("", bezel, sides), dial_to_clock));
    for (int hour = 0; hour < 12; ++hour) {
      const glm::vec2 way = circle_point(hour / 12.0);
      const glm::mat4 turn(glm::vec4(way.y, -way.x, 0, 0), glm::vec4(way, 0, 0), glm::vec4(0, 0, 1, 0),
                           glm::vec4(x + 0.40F * way.x, 0.71F + 0.40F * way.y, 0.372F, 1));
      append_mesh(hands, transform_mesh(make_box("", {-0.012F, -0.035F, 0}, {0.012F, 0.035F, 0.004F}), turn));
    }
    for (const float length : {0.24F, 0.34F}) {
      const glm::vec2 way = circle_point(length < 0.3F ? 0.13 + 0.1 * static_cast<double>(x) : 0.31);
      const glm::mat4 turn(glm::vec4(way.y, -way.x, 0, 0), glm::vec4(way, 0, 0), glm::vec4(0, 0, 1, 0),
                           glm::vec4(x, 0.71F, 0.38F, 1));
      append_mesh(hands, transform_mesh(make_box("", {-0.016F, -0.05F, 0}, {0.016F, length, 0.006F}), turn));
    }
    const glm::vec2 knob[] = {
        {0.11F, 0}, {0.11F, x < 0 ? 0.10F : 0.2F}, {0.09F, x < 0 ? 0.13F : 0.23F}, {0, x < 0 ? 0.14F : 0.24F}};
    append_mesh(buttons, transform_mesh(make_lathe("", knob, detail.cell_count(20, 8)), placement_at({x, 1.34F, 0})));
  }
  dials.name = "dials", rings.name = "bezels", hands.name = "hands", buttons.name = "buttons";
  part(std::move(dials), ivory);
  part(std::move(rings), brass);
  part(std::move(hands), black);
  part(std::move(buttons), brass);
}

/// Adds six bright panes, which light the room, in the wall on the left.
void add_window(Scene& scene, std::uint32_t frame_paint) {
  const std::uint32_t sky = add_material(scene, make_lamp("daylight", {14, 14.5F, 15.5F}));
  Mesh panes;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const float z = -3.2F + 2.8F * static_cast<float>(column), y = 1.2F + 3.4F * static_cast<float>(row);
      append_mesh(panes, make_quad("", {kLeft + 0.3F, y, z}, {0, 3.1F, 0}, {0, 0, 2.5F}, 1));
    }
  }
  panes.name = "window";
  add_object(scene, std::move(panes), sky);
  add_object(scene, make_box("window frame", {kLeft, 0.6F, -3.8F}, {kLeft + 0.2F, 11.7F, 5.5F}), frame_paint);
}

/// Adds board (64 squares of 1 x 1 about the origin, their tops at y = 0), table, clock and the room with its window.
void add_surroundings(Scene& scene, const Detail& detail) {
  const std::uint32_t maple =
      add_texture(scene, wood_texture("maple", {0.93F, 0.80F, 0.60F}, {0.80F, 0.61F, 0.38F}, 11));
  const std::uint32_t walnut =
      add_texture(scene, wood_texture("walnut", {0.46F, 0.28F, 0.17F}, {0.26F, 0.14F, 0.08F}, 12));
  const std::uint32_t mahogany =
      add_texture(scene, wood_texture("mahogany", {0.52F, 0.25F, 0.14F}, {0.30F, 0.11F, 0.06F}, 13));
  const std::uint32_t parquet =
      add_texture(scene, wood_texture("parquet", {0.62F, 0.45F, 0.30F}, {0.42F, 0.27F, 0.17F}, 14, 256));
  const std::uint32_t cloth =
      add_texture(scene, cloth_texture("wallpaper", {0.36F, 0.45F, 0.41F}, {0.31F, 0.40F, 0.37F}, 64, 15, 256));

  add_object(scene, make_squares(true), add_material(scene, make_textured("maple", maple, glm::vec3(1), 0.10F)));
  const std::uint32_t dark = add_material(scene, make_textured("walnut", walnut, glm::vec3(1), 0.12F));
  add_object(scene, make_squares(false), dark);
  add_object(scene, make_frame(), dark);
  const std::uint32_t table = add_material(scene, make_textured("mahogany", mahogany, glm::vec3(1), 0.15F));
  Mesh top =
      make_rounded_box("table", {-11, kTableTop - 0.7F, -7.5F}, {11, kTableTop, 7.5F}, 0.25F, detail.cell_count(4));
  for (std::size_t k = 0; k < top.uvs.size(); ++k) {
    const glm::vec3 p = top.positions[k];
    top.uvs[k] = {0.04F * p.x + 0.3F, 0.06F * p.z + 0.06F * p.y + 0.5F};
  }
  add_object(scene, std::move(top), table);
  const glm::vec2 leg[] = {{0.35F, kFloor}, {0.45F, kFloor + 0.6F}, {0.3F, kFloor + 1}, {0.55F, -3},
                           {0.4F, -2},      {0.6F, -1.1F}};
  const std::uint32_t leg_mesh = add_mesh(scene, make_lathe("leg", leg, detail.cell_count(12, 6)), table);
  for (const float x : {-9.8F, 9.8F}) {
    for (const float z : {-6.3F, 6.3F}) add_instance(scene, leg_mesh, placement_at({x, 0, z}));
  }

  const std::uint32_t enamel = add_material(scene, make_paint("black enamel", {0.02F, 0.02F, 0.02F}, 0.05F));
  const std::uint32_t ivory = add_material(scene, make_paint("ivory", {0.88F, 0.84F, 0.74F}, 0.05F));
  const std::uint32_t brass = add_material(scene, make_metal("brass", {0.95F, 0.72F, 0.35F}, 0.6F));
  add_clock(scene, detail, dark, brass, ivory, enamel);

  const glm::vec3 x(kRight - kLeft, 0, 0), y(0, kCeiling - kFloor, 0), z(0, 0, kFront - kBack);
  const glm::vec3 corner(kLeft, kFloor, kBack), far_corner(kRight, kCeiling, kFront);
  const std::uint32_t wall = add_material(scene, make_textured("wallpaper", cloth));
  add_object(scene, make_quad("floor", corner, z, x, 2, 5),
             add_material(scene, make_textured("parquet", parquet, glm::vec3(1), 0.06F)));
  add_object(scene, make_quad("back wall", corner, x, y, 2, 6), wall);
  add_object(scene, make_quad("left wall", corner, y, z, 2, 6), wall);
  add_object(scene, make_quad("right wall", far_corner, -y, -z, 2, 6), wall);
  add_object(scene, make_quad("front wall", far_corner, -x, -y, 2, 6), wall);
  const std::uint32_t plaster = add_material(scene, make_paint("plaster", {0.85F, 0.83F, 0.78F}));
  add_object(scene, make_quad("ceiling", far_corner, -z, -x, 2), plaster);
  add_window(scene, plaster);
  // Panelling along the back wall.
  const std::uint32_t panel = add_mesh(
      scene, make_rounded_box("panel", {-1.9F, -4.4F, 0}, {1.9F, 4.4F, 0.3F}, 0.14F, detail.cell_count(1.4)), table);
  for (int k = 0; k < 8; ++k) {
    add_instance(scene, panel,
                 placement_at({kLeft + 2.2F + 4.2F * static_cast<float>(k), kFloor + 4.8F, kBack + 0.1F}));
  }
  add_object(scene,
             make_rounded_box("rail", {kLeft, kFloor + 9.5F, kBack}, {kRight, kFloor + 10.1F, kBack + 0.6F}, 0.15F, 2),
             table);
}

}  // namespace
}  // namespace traces::chess

namespace traces {
namespace {

using chess::Piece;

/// A kind of chess piece, and the squares of its pieces as one text, such as "c3f3".
struct Placement {
  Piece piece;
  bool white;
  std::string_view squares;
};

// The position in Legal's mate after the fourth move. The animation plays 5. Nxe5 Bxd1.
constexpr Placement kPosition[] = {
    {Piece::kPawn, true, "a2b2c2d2e4f2g2h2"},
    {Piece::kRook, true, "a1h1"},
    {Piece::kKnight, true, "c3f3"},
    {Piece::kBishop, true, "c1c4"},
    {Piece::kQueen, true, "d1"},
    {Piece::kKing, true, "e1"},
    {Piece::kPawn, false, "a7b7c7d6e5f7g6h7"},
    {Piece::kRook, false, "a8h8"},
    {Piece::kKnight, false, "b8g8"},
    {Piece::kBishop, false, "f8g4"},
    {Piece::kQueen, false, "d8"},
    {Piece::kKing, false, "e8"},
};

/// Returns the middle of a square of the board, such as "e4"; White sits at +z.
glm::vec3 square_middle(std::string_view name) {
  return {static_cast<float>(name[0] - 'a') - 3.5F, 0, 3.5F - static_cast<float>(name[1] - '1')};
}

struct Move {
  std::string_view from;
  glm::vec3 to;
  float start, end;
  float height;  ///< height of the arc on which the piece moves
};

/// Returns the animated moves: pawn e5 leaves, a knight takes its place, queen d1 leaves, a bishop takes her place.
std::array<Move, 4> game_moves() {
  const float table = chess::kTableTop;
  return {{{"e5", {5.75F, table, -1.2F}, 0.4F, 1.9F, 2.2F},
           {"f3", square_middle("e5"), 1.2F, 2.6F, 1.6F},
           {"d1", {-5.8F, table, 1.9F}, 3.0F, 4.5F, 2.4F},
           {"g4", square_middle("d1"), 3.7F, 5.5F, 2.0F}}};
}

/// Animates the node of a piece: lift, carry, set down.
void animate_move(Scene& scene, std::uint32_t node, const Move& move) {
  constexpr int kSamples = 24;
  const glm::vec3 from = square_middle(move.from);
  std::vector<Key> keys{{0, from}};
  for (int k = 0; k <= kSamples; ++k) {
    const float t = static_cast<float>(k) / kSamples;
    const float share = glm::smoothstep(0.1F, 0.9F, t);
    const float lift = 4 * t * (1 - t);
    keys.push_back({move.start + t * (move.end - move.start),
                    glm::mix(from, move.to, share) + glm::vec3(0, move.height * lift * (1.6F - 0.6F * lift), 0)});
  }
  keys.push_back({6, move.to});
  add_translation_track(scene, node, keys);
}

void add_pieces(Scene& scene, const Detail& detail) {
  const std::uint32_t boxwood =
      add_texture(scene, wood_texture("boxwood", {0.93F, 0.76F, 0.50F}, {0.82F, 0.60F, 0.34F}, 21, 256));
  const std::uint32_t rosewood =
      add_texture(scene, wood_texture("rosewood", {0.23F, 0.10F, 0.07F}, {0.12F, 0.05F, 0.04F}, 22, 256));
  const std::uint32_t white = add_material(scene, make_textured("lacquered boxwood", boxwood, glm::vec3(1), 0.12F));
  const std::uint32_t black = add_material(scene, make_textured("lacquered rosewood", rosewood, glm::vec3(1), 0.2F));
  for (const Placement& group : kPosition) {
    const std::uint32_t mesh = add_mesh(scene, chess::make_piece(group.piece, detail), group.white ? white : black);
    for (std::size_t k = 0; k < group.squares.size(); k += 2) {
      const std::string_view name = group.squares.substr(k, 2);
      const double turns = (group.white ? 0.0 : 0.5) + static_cast<double>(random_between(-0.02F, 0.02F, k, 31));
      const std::uint32_t instance = add_instance(scene, mesh, placement_at(square_middle(name), turns));
      for (const Move& move : game_moves()) {
        if (move.from != name) continue;
        const Transform rest{.translation = square_middle(name), .rotation = axis_rotation({0, 1, 0}, turns)};
        const std::uint32_t node = add_node(scene, std::string(name), rest);
        attach_to_node(scene, instance, node);
        animate_move(scene, node, move);
      }
    }
  }
}

std::uint64_t triangles_of_set(const Detail& detail) {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < chess::kPieces; ++k) {
    sum += 2 * chess::kInSet[k] * chess::make_piece(static_cast<Piece>(k), detail).triangles.size();
  }
  return sum;
}

}  // namespace

/// Builds a chess game on a wooden board by a window: many glossy curved pieces that mirror each other.
Scene build_chess(const BuiltinOptions& options) {
  Scene scene;
  scene.name = "chess";
  scene.background = glm::vec3(0.05F);
  constexpr std::uint32_t kClass = 42'000;
  const std::uint64_t wanted = options.triangles_or_default(kClass);
  chess::add_surroundings(scene, detail_for(static_cast<double>(wanted), kClass));
  add_pieces(scene, fit_detail(wanted, triangles_of_set, {.made = count_triangles(scene)}));

  scene.cameras.push_back(look_at("front", {4.6F, 4.7F, 8.9F}, {0.12F, -0.15F, 0.35F}, 0.55F));
  scene.cameras.push_back(look_at("player", {0, 6.5F, 9.5F}, {0, 0, 0.2F}, 0.62F));
  const ViewKey path[] = {{0, {5.6F, 3.4F, 7.2F}, {0.8F, 0.4F, 0.4F}},
                          {1.5F, {3.2F, 2.9F, 6.6F}, {0.8F, 0.5F, 0}},
                          {3, {0.4F, 2.6F, 6.6F}, {0.3F, 0.4F, 0.4F}},
                          {4.5F, {-2.6F, 3.2F, 7.2F}, {-0.2F, 0.4F, 1.2F}},
                          {6, {-5.0F, 4.4F, 7.8F}, {-0.3F, 0.3F, 0.8F}}};
  add_camera_path(scene, "path", path, 0.6F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
