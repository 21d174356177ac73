#include "traces/scenes/chess/pieces.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::chess {
namespace {

/// Makes the profile of the foot that all pieces have: a heavy ring and a step.
Outline make_foot(float radius) {
  return Outline({0, 0})
      .line_to(radius - 0.02F, 0)
      .arc_to(radius - 0.01F, 0.12F, 0.028F)
      .line_to(radius - 0.05F, 0.135F)
      .arc_to(radius - 0.09F, 0.20F, 0.018F)
      .line_to(radius - 0.115F, 0.21F);
}

/// Adds a ring around the neck of a piece to its profile.
Outline& add_collar(Outline& outline, float radius, float height, float thickness) {
  return outline.line_to(radius - 0.02F, height)
      .arc_to(radius - 0.02F, height + thickness, 0.6F * thickness)
      .line_to(radius - 0.07F, height + 1.3F * thickness);
}

Mesh turn_outline(const Outline& outline, const Detail& detail, double points) {
  return make_lathe("", simplify_line(outline.points(), detail.cell_count(points, 10)), detail.cell_count(26, 8));
}

Mesh make_pawn(const Detail& detail) {
  Outline o = make_foot(0.30F);
  o.arc_to(0.095F, 0.50F, -0.05F);
  add_collar(o, 0.19F, 0.52F, 0.04F);
  o.add_arc({0, 0.70F}, 0.145F, -0.15, 0.25);
  return turn_outline(o, detail, 20);
}

/// Adds six battlements to a rook: sectors of a ring.
void add_battlements(Mesh& rook, const Detail& detail) {
  const std::uint32_t steps = detail.cell_count(4, 2);
  for (int k = 0; k < 6; ++k) {
    std::vector<glm::vec2> outline;
    for (const float radius : {0.265F, 0.185F}) {
      for (std::uint32_t i = 0; i <= steps; ++i) {
        const double share = static_cast<double>(radius > 0.2F ? i : steps - i) / steps;
        outline.push_back(radius * circle_point((k + 0.14 + 0.72 * share) / 6));
      }
    }
    Mesh block = make_extrusion("", outline, 0.11F);
    for (glm::vec3& p : block.positions) p = {p.x, p.z + 0.845F, -p.y};
    for (glm::vec3& n : block.normals) n = {n.x, n.z, -n.y};
    append_mesh(rook, block);
  }
}

Mesh make_rook(const Detail& detail) {
  Outline o = make_foot(0.33F);
  o.arc_to(0.165F, 0.64F, -0.04F)
      .line_to(0.20F, 0.66F)
      .arc_to(0.20F, 0.70F, 0.02F)
      .line_to(0.185F, 0.71F)
      .arc_to(0.265F, 0.78F, -0.02F);
  o.line_to(0.265F, 0.85F).line_to(0.185F, 0.85F).line_to(0.185F, 0.80F).line_to(0, 0.80F);
  Mesh rook = turn_outline(o, detail, 24);
  add_battlements(rook, detail);
  return rook;
}

/// Makes a bishop's mitre with its slit: rows near the slit lean forward, and the slit ends at the back.
Mesh make_mitre(const Detail& detail) {
  constexpr float kLow = 0.86F, kHeight = 0.36F;
  const auto radius = [](float share) {  // 0 at the neck, 1 at the tip
    const float full = 1 - share;
    return 0.085F * full + 0.62F * share * full * (1 - 0.42F * share);
  };
  std::vector<glm::vec2> profile;
  std::vector<float> depth;
  const auto row = [&](float share, float cut) {
    profile.emplace_back(radius(share), kLow + kHeight * share);
    depth.push_back(cut);
  };
  const std::uint32_t below = detail.cell_count(6, 3), above = detail.cell_count(5, 3);
  for (std::uint32_t k = 0; k <= below; ++k) row(0.50F * static_cast<float>(k) / static_cast<float>(below), 0);
  row(0.50F, 0), row(0.51F, 0.09F), row(0.51F, 0.09F), row(0.59F, 0.09F), row(0.59F, 0.09F), row(0.60F, 0),
      row(0.60F, 0);
  for (std::uint32_t k = 1; k <= above; ++k) row(0.60F + 0.40F * static_cast<float>(k) / static_cast<float>(above), 0);
  return make_turned("", profile, detail.cell_count(26, 10), [&](float around, std::size_t k, const glm::vec3& p) {
    const float forward = 0.5F - 0.5F * cos_turns(static_cast<double>(around));  // 1 at the front (-x)
    const float open = glm::smoothstep(0.25F, 0.6F, forward);
    const float r = profile[k].x;
    const float in = r > 0 ? (r - depth[k] * open) / r : 1;
    const float share = (p.y - kLow) / kHeight;
    const float lean = share < 0.5F ? glm::smoothstep(0.1F, 0.5F, share) : 1 - glm::smoothstep(0.6F, 0.97F, share);
    return glm::vec3(p.x * in, p.y + 0.8F * p.x * lean, p.z * in);
  });
}

Mesh make_bishop(const Detail& detail) {
  Outline o = make_foot(0.32F);
  o.arc_to(0.10F, 0.68F, -0.06F);
  add_collar(o, 0.21F, 0.70F, 0.045F);
  add_collar(o, 0.165F, 0.775F, 0.035F).line_to(0.085F, 0.86F).line_to(0, 0.86F);
  Mesh bishop = turn_outline(o, detail, 24);
  append_mesh(bishop, transform_mesh(make_mitre(detail), placement_at({0, 0, 0}, -0.17)));
  const Outline ball = Outline({0, 1.19F}).add_arc({0, 1.24F}, 0.05F, -0.25, 0.25);
  append_mesh(bishop, make_lathe("", simplify_line(ball.points(), detail.cell_count(8, 4)), detail.cell_count(14, 5)));
  return bishop;
}

/// Makes the profile of queen and king up to the crown, which begins at radius 0.14.
Outline royal_body(float radius, float neck) {
  Outline o = make_foot(radius);
  o.line_to(radius - 0.10F, 0.25F).arc_to(0.125F, neck, -0.075F);
  add_collar(o, 0.255F, neck + 0.02F, 0.05F);
  add_collar(o, 0.205F, neck + 0.10F, 0.04F);
  o.line_to(0.135F, neck + 0.16F);
  return o;
}

Mesh make_queen(const Detail& detail) {
  constexpr float kNeck = 0.98F;
  Outline o = royal_body(0.36F, kNeck);
  o.line_to(0, kNeck + 0.16F);
  Mesh queen = turn_outline(o, detail, 26);
  // The coronet: a flaring cup with nine points, and a dome with a ball inside.
  constexpr int kPoints = 9;
  Outline cup({0.13F, kNeck + 0.15F});
  cup.arc_to(0.235F, kNeck + 0.38F, -0.02F);
  std::vector<glm::vec2> profile = simplify_line(cup.points(), detail.cell_count(6, 4));
  const std::size_t rim = profile.size() - 1;
  profile.push_back(profile.back());
  profile.emplace_back(0.20F, kNeck + 0.385F);
  profile.push_back(profile.back());
  profile.emplace_back(0.165F, kNeck + 0.33F);
  const std::uint32_t segments = kPoints * detail.cell_count(4, 2);
  append_mesh(queen, make_turned("", profile, segments, [&](float around, std::size_t k, const glm::vec3& p) {
                if (k < rim || k > rim + 3) return p;
                const float wave = 0.5F + 0.5F * cos_turns(static_cast<double>(around) * kPoints);
                return p + glm::vec3(0, 0.075F * wave * wave - 0.02F, 0);
              }));
  Outline dome({0.175F, kNeck + 0.33F});
  dome.arc_to(0.04F, kNeck + 0.44F, 0.045F).add_arc({0, kNeck + 0.485F}, 0.052F, -0.13, 0.25);
  append_mesh(queen, turn_outline(dome, detail, 11));
  return queen;
}

Mesh make_king(const Detail& detail) {
  constexpr float kNeck = 1.06F;
  Outline o = royal_body(0.37F, kNeck);
  o.arc_to(0.215F, kNeck + 0.40F, -0.015F).line_to(0.225F, kNeck + 0.41F).arc_to(0.215F, kNeck + 0.44F, 0.01F);
  o.arc_to(0.07F, kNeck + 0.53F, 0.03F).arc_to(0.055F, kNeck + 0.57F, 0.02F).line_to(0, kNeck + 0.575F);
  Mesh king = turn_outline(o, detail, 34);
  // A cross patty.
  const glm::vec2 quarter[] = {{0.022F, 0.025F}, {0.085F, 0.048F}, {0.085F, -0.048F}};
  std::vector<glm::vec2> outline;
  for (int arm = 0; arm < 4; ++arm) {
    for (const glm::vec2& p : {quarter[2], quarter[1], quarter[0]}) {
      const glm::vec2 q = arm == 0 ? p : arm == 1 ? glm::vec2(-p.y, p.x) : arm == 2 ? -p : glm::vec2(p.y, -p.x);
      outline.push_back(q);
    }
  }
  append_mesh(king, transform_mesh(make_extrusion("", outline, 0.055F), placement_at({0, kNeck + 0.645F, -0.0275F})));
  return king;
}

Mesh make_knight(const Detail& detail) {
  Outline o = make_foot(0.33F);
  o.line_to(0.24F, 0.24F).arc_to(0.25F, 0.275F, 0.012F).line_to(0.20F, 0.285F).line_to(0, 0.285F);
  Mesh knight = turn_outline(o, detail, 14);
  append_mesh(knight, make_horse(detail));
  return knight;
}

}  // namespace

Mesh make_piece(Piece piece, const Detail& detail) {
  const char* const names[kPieces] = {"pawn", "rook", "knight", "bishop", "queen", "king"};
  Mesh (*const makers[kPieces])(const Detail&) = {make_pawn,   make_rook,  make_knight,
                                                  make_bishop, make_queen, make_king};
  Mesh mesh = makers[static_cast<std::size_t>(piece)](detail);
  mesh.name = names[static_cast<std::size_t>(piece)];
  // The grain of turned wood runs up the piece.
  for (std::size_t k = 0; k < mesh.uvs.size(); ++k) {
    const glm::vec3 p = mesh.positions[k];
    mesh.uvs[k] = {0.35F * p.y, 0.45F * p.x + 0.25F * p.z};
  }
  return mesh;
}

namespace {

/// A cross-section of a knight's neck or head: its ends in the plane of symmetry (forward, up) and half its width.
struct Cut {
  glm::vec2 back, front;
  float half_width;
};

// Cross-sections from the collar up the neck, over the poll and down to the muzzle.
constexpr Cut kCuts[] = {
    {{-0.255F, 0.26F}, {0.250F, 0.26F}, 0.235F},  {{-0.285F, 0.38F}, {0.245F, 0.35F}, 0.215F},
    {{-0.305F, 0.53F}, {0.190F, 0.45F}, 0.180F},  {{-0.290F, 0.70F}, {0.100F, 0.55F}, 0.150F},
    {{-0.235F, 0.86F}, {0.050F, 0.63F}, 0.135F},  {{-0.150F, 0.99F}, {0.045F, 0.69F}, 0.130F},
    {{-0.045F, 1.06F}, {0.080F, 0.69F}, 0.135F},  {{0.065F, 1.045F}, {0.140F, 0.65F}, 0.130F},
    {{0.150F, 0.975F}, {0.205F, 0.62F}, 0.115F},  {{0.230F, 0.880F}, {0.250F, 0.590F}, 0.095F},
    {{0.305F, 0.790F}, {0.285F, 0.550F}, 0.085F}, {{0.360F, 0.715F}, {0.315F, 0.520F}, 0.082F},
    {{0.390F, 0.650F}, {0.345F, 0.510F}, 0.070F}, {{0.395F, 0.600F}, {0.370F, 0.530F}, 0.040F},
    {{0.390F, 0.565F}, {0.390F, 0.565F}, 0.000F},
};

Mesh make_head(const Detail& detail) {
  std::vector<glm::vec3> backs, fronts;  // z is half the width
  for (const Cut& cut : kCuts) {
    backs.emplace_back(cut.back, cut.half_width);
    fronts.emplace_back(cut.front, cut.half_width);
  }
  constexpr std::uint32_t kFine = 16;
  backs = catmull_rom(std::span<const glm::vec3>(backs), kFine);
  fronts = catmull_rom(std::span<const glm::vec3>(fronts), kFine);
  const auto last = static_cast<float>(backs.size() - 1);
  return make_surface(
      "", detail.cell_count(20, 8), detail.cell_count(34, 9),
      [&](float s, float t) {
        const auto k = static_cast<std::size_t>(t * last + 0.5F);
        const glm::vec2 round = circle_point(static_cast<double>(s));
        const glm::vec2 middle = 0.5F * glm::vec2(backs[k] + fronts[k]);
        const glm::vec2 p = middle + 0.5F * glm::vec2(fronts[k] - backs[k]) * round.x;
        // Wider than an ellipse at the jowls, narrower towards the throat.
        const float half_width = backs[k].z * (1 - 0.12F * round.x);
        return glm::vec3(-half_width * round.y, p.y, -p.x);
      },
      true);
}

/// Makes the locks of a knight's mane along the crest, thin and serrated.
Mesh make_mane() {
  const glm::vec2 crest[] = {{-0.240F, 0.42F}, {-0.270F, 0.55F}, {-0.255F, 0.70F}, {-0.205F, 0.84F},
                             {-0.125F, 0.96F}, {-0.030F, 1.03F}, {0.060F, 1.03F}};
  const std::vector<glm::vec2> line = catmull_rom(std::span<const glm::vec2>(crest), 3);
  std::vector<glm::vec2> outline;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const glm::vec2 along = glm::normalize(line[std::min(k + 1, line.size() - 1)] - line[k == 0 ? 0 : k - 1]);
    const glm::vec2 out(-along.y, along.x);
    outline.push_back(line[k] + out * (k % 3 == 0 ? 0.050F : 0.095F) - along * 0.02F);
  }
  for (std::size_t k = line.size(); k-- > 0;) outline.push_back(line[k]);
  std::reverse(outline.begin(), outline.end());
  constexpr float kWidth = 0.075F;
  Mesh mane = make_extrusion("", outline, kWidth);
  for (glm::vec3& p : mane.positions) p = {p.z - 0.5F * kWidth, p.y, -p.x};
  for (glm::vec3& n : mane.normals) n = {n.z, n.y, -n.x};
  return mane;
}

}  // namespace

Mesh make_horse(const Detail& detail) {
  Mesh horse = make_head(detail);
  if (detail.share >= 0.5) append_mesh(horse, make_mane());
  const std::uint32_t sides = detail.cell_count(8, 4);
  for (const float side : {-1.0F, 1.0F}) {
    const glm::vec2 ear[] = {{0.020F, 0}, {0.042F, 0.045F}, {0.036F, 0.09F}, {0, 0.165F}};
    append_mesh(horse, transform_mesh(make_lathe("", ear, sides), placement_at({side * 0.062F, 1.0F, 0.02F})));
    const Outline eye = Outline({0, -0.028F}).add_arc({0, 0}, 0.028F, -0.25, 0.25);
    append_mesh(horse, transform_mesh(make_lathe("", simplify_line(eye.points(), detail.cell_count(6, 4)), sides),
                                      placement_at({side * 0.105F, 0.90F, -0.135F})));
    append_mesh(horse, transform_mesh(make_lathe("", simplify_line(eye.points(), detail.cell_count(6, 4)), sides),
                                      placement_at({side * 0.06F, 0.625F, -0.35F}, 0, glm::vec3(0.8F))));
  }
  return horse;
}

}  // namespace traces::chess
