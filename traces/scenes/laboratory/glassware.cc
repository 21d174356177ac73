#include "traces/scenes/laboratory/glassware.h"

#include <algorithm>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/modelling/shapes.h"

namespace traces::laboratory {
namespace {

constexpr float kWall = 0.002F;  ///< thickness of the glass
constexpr float kGap = 0.0015F;  ///< gap between glass and filling; larger than the start offset of rays

/// Returns the outer profile of a vessel, from the middle of the bottom to the rim.
Outline outer_profile(Vessel vessel) {
  Outline o({0, 0});
  switch (vessel) {
    case Vessel::kBeaker:
      return o.line_to(0.034F, 0)
          .arc_to(0.040F, 0.007F, 0.0018F)
          .line_to(0.040F, 0.099F)
          .arc_to(0.044F, 0.106F, -0.0012F);
    case Vessel::kErlenmeyer:
      o.line_to(0.041F, 0).arc_to(0.046F, 0.009F, 0.0025F).line_to(0.0185F, 0.098F).arc_to(0.0165F, 0.110F, -0.0008F);
      return o.line_to(0.0165F, 0.138F).arc_to(0.0205F, 0.145F, -0.001F);
    case Vessel::kRound:
      return o.add_arc({0, 0.050F}, 0.050F, -0.25, 0.195)
          .line_to(0.0165F, 0.108F)
          .line_to(0.0165F, 0.152F)
          .arc_to(0.0200F, 0.158F, -0.001F);
    case Vessel::kTestTube:
      return o.add_arc({0, 0.0095F}, 0.0095F, -0.25, 0).line_to(0.0095F, 0.148F).arc_to(0.0115F, 0.152F, -0.0006F);
    case Vessel::kBurette:
      return Outline({0.003F, 0}).line_to(0.004F, 0.035F).arc_to(0.0085F, 0.050F, 0.001F).line_to(0.0085F, 0.40F);
    case Vessel::kCylinder:
      return o.line_to(0.012F, 0)
          .arc_to(0.0155F, 0.004F, 0.001F)
          .line_to(0.0155F, 0.205F)
          .arc_to(0.0185F, 0.211F, -0.0008F);
    case Vessel::kVolumetric:
      o.line_to(0.026F, 0).arc_to(0.043F, 0.030F, 0.004F).arc_to(0.0095F, 0.090F, 0.012F);
      return o.line_to(0.0085F, 0.105F).line_to(0.0085F, 0.188F).arc_to(0.0115F, 0.194F, -0.0006F);
    case Vessel::kBottle:
      o.line_to(0.031F, 0).arc_to(0.035F, 0.005F, 0.0012F).line_to(0.035F, 0.084F).arc_to(0.0150F, 0.106F, 0.006F);
      return o.line_to(0.0145F, 0.118F).line_to(0.0185F, 0.120F).line_to(0.0185F, 0.126F);
    default:
      return o.line_to(0.044F, 0).arc_to(0.046F, 0.002F, 0.0005F).line_to(0.046F, 0.015F);
  }
}

std::vector<glm::vec2> vessel_profile(Vessel vessel, const Detail& detail) {
  return simplify_line(outer_profile(vessel).points(), detail.cell_count(16, 7));
}

/// Returns a line moved inwards by a distance. Its first point remains on the axis.
std::vector<glm::vec2> inset_line(const std::vector<glm::vec2>& line, float by) {
  std::vector<glm::vec2> out;
  const std::size_t last = line.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const glm::vec2 before = line[k] - line[k == 0 ? 0 : k - 1], after = line[std::min(k + 1, last)] - line[k];
    const auto outward = [](const glm::vec2& d) {
      return glm::dot(d, d) > 0 ? glm::normalize(glm::vec2(d.y, -d.x)) : glm::vec2(0);
    };
    const glm::vec2 normal = glm::normalize(outward(before) + outward(after));
    out.push_back(line[k] - by * normal);
    if (line[k].x <= 0) out.back().x = 0;
    out.back().x = std::max(out.back().x, 0.0F);
  }
  return out;
}

std::uint32_t round_segments(const Detail& detail) { return detail.cell_count(36, 10); }

}  // namespace

Mesh make_vessel(Vessel vessel, const Detail& detail) {
  std::vector<glm::vec2> profile = vessel_profile(vessel, detail);
  const std::vector<glm::vec2> inner = inset_line(profile, kWall);
  profile.insert(profile.end(), inner.rbegin(), inner.rend());
  Mesh mesh = make_lathe("glass", profile, round_segments(detail));
  if (vessel == Vessel::kBeaker) {
    for (glm::vec3& p : mesh.positions) {  // the spout
      const float across = std::max(1 - (p.z / 0.016F) * (p.z / 0.016F), 0.0F);
      if (p.x > 0) p += glm::vec3(0.009F, 0.002F, 0) * across * glm::smoothstep(0.090F, 0.106F, p.y);
    }
  }
  return mesh;
}

Mesh make_filling(Vessel vessel, float height, const Detail& detail) {
  const std::vector<glm::vec2> wall = inset_line(vessel_profile(vessel, detail), kWall + kGap);
  std::vector<glm::vec2> profile{wall.front()};
  for (std::size_t k = 1; k < wall.size(); ++k) {
    if (wall[k].y >= height) {
      const glm::vec2 a = wall[k - 1], b = wall[k];
      const float share = std::clamp((height - a.y) / std::max(b.y - a.y, 1e-6F), 0.0F, 1.0F);
      profile.push_back(a + share * (b - a));
      break;
    }
    profile.push_back(wall[k]);
  }
  profile.emplace_back(0, profile.back().y);
  return make_lathe("filling", profile, round_segments(detail));
}

}  // namespace traces::laboratory
