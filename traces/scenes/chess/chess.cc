#include <array>
#include <string_view>
#include <vector>

#include <glm/common.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/chess/pieces.h"
#include "traces/scenes/chess/table.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/modelling/turned.h"

namespace traces {
namespace {

using chess::Piece;

/// A kind of piece and its squares in the order of pieces: "g1".
struct Placement {
  Piece piece;
  bool white;
  std::string_view squares;
};

// Legal's mate after the fourth move; the animation plays 5. Nxe5 Bxd1.
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

/// Returns the middle of a square; White sits at +z.
glm::vec3 square(std::string_view name) {
  return {static_cast<float>(name[0] - 'a') - 3.5F, 0, 3.5F - static_cast<float>(name[1] - '1')};
}

struct Move {
  std::string_view from;
  glm::vec3 to;
  float start, end;
  float height;  ///< height of the arc
};

/// Returns the moves: the pawn on e5 leaves, a knight takes its place, the queen on d1 leaves, a bishop takes her
/// place.
std::array<Move, 4> moves() {
  const float table = chess::kTableTop;
  return {{{"e5", {5.75F, table, -1.2F}, 0.4F, 1.9F, 2.2F},
           {"f3", square("e5"), 1.2F, 2.6F, 1.6F},
           {"d1", {-5.8F, table, 1.9F}, 3.0F, 4.5F, 2.4F},
           {"g4", square("d1"), 3.7F, 5.5F, 2.0F}}};
}

/// Animates a move: lift, carry, set down.
void animate(Scene& scene, std::uint32_t node, const Move& move) {
  constexpr int kSamples = 24;
  const glm::vec3 from = square(move.from);
  std::vector<Key> keys{{0, from}};
  for (int k = 0; k <= kSamples; ++k) {
    const float t = static_cast<float>(k) / kSamples;
    const float share = glm::smoothstep(0.1F, 0.9F, t);
    const float lift = 4 * t * (1 - t);
    keys.push_back({move.start + t * (move.end - move.start),
                    glm::mix(from, move.to, share) + glm::vec3(0, move.height * lift * (1.6F - 0.6F * lift), 0)});
  }
  keys.push_back({6, move.to});
  move_node(scene, node, keys);
}

void add_pieces(Scene& scene, const Detail& detail) {
  scene.textures.push_back(wood_texture("boxwood", {0.93F, 0.76F, 0.50F}, {0.82F, 0.60F, 0.34F}, 21, 256));
  const auto boxwood = static_cast<std::uint32_t>(scene.textures.size() - 1);
  scene.textures.push_back(wood_texture("rosewood", {0.23F, 0.10F, 0.07F}, {0.12F, 0.05F, 0.04F}, 22, 256));
  const std::uint32_t white = add_material(scene, textured("lacquered boxwood", boxwood, glm::vec3(1), 0.12F));
  const std::uint32_t black = add_material(scene, textured("lacquered rosewood", boxwood + 1, glm::vec3(1), 0.2F));
  for (const Placement& group : kPosition) {
    const std::uint32_t mesh = add_mesh(scene, chess::make_piece(group.piece, detail), group.white ? white : black);
    for (std::size_t k = 0; k < group.squares.size(); k += 2) {
      const std::string_view name = group.squares.substr(k, 2);
      const double turns = (group.white ? 0.0 : 0.5) + static_cast<double>(random_between(-0.02F, 0.02F, k, 31));
      const std::uint32_t instance = add_instance(scene, mesh, placed(square(name), turns));
      for (const Move& move : moves()) {
        if (move.from != name) continue;
        const Transform rest{.translation = square(name), .rotation = rotation({0, 1, 0}, turns)};
        const std::uint32_t node = add_node(scene, std::string(name), rest);
        hang(scene, instance, node);
        animate(scene, node, move);
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

/// A game on a wooden board by a window: many glossy curved pieces that mirror each other.
Scene build_chess(const BuiltinOptions& options) {
  Scene scene;
  scene.name = "chess";
  scene.background = glm::vec3(0.05F);
  constexpr std::uint32_t kClass = 42'000;
  const std::uint64_t wanted = options.triangles_or(kClass);
  chess::add_surroundings(scene, detail_for(static_cast<double>(wanted), kClass));
  add_pieces(scene, fit_detail(wanted, triangles_of_set, {.made = triangles_of(scene)}));

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
