#include <algorithm>
#include <vector>

#include <glm/common.hpp>

#include "traces/scenes/chess/pieces.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/modelling/turned.h"

namespace traces::chess {
namespace {

/// A section of neck or head: its ends in the plane of symmetry (forward, up) and half its width.
struct Cut {
  glm::vec2 back, front;
  float half_width;
};

// From the collar up the neck, over the poll and down to the muzzle.
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
  backs = smoothed(std::span<const glm::vec3>(backs), kFine);
  fronts = smoothed(std::span<const glm::vec3>(fronts), kFine);
  const auto last = static_cast<float>(backs.size() - 1);
  return make_surface(
      "", detail.cells(20, 8), detail.cells(34, 9),
      [&](float s, float t) {
        const auto k = static_cast<std::size_t>(t * last + 0.5F);
        const glm::vec2 round = on_circle(static_cast<double>(s));
        const glm::vec2 middle = 0.5F * glm::vec2(backs[k] + fronts[k]);
        const glm::vec2 p = middle + 0.5F * glm::vec2(fronts[k] - backs[k]) * round.x;
        // Wider than an ellipse at the jowls, narrower towards the throat.
        const float half_width = backs[k].z * (1 - 0.12F * round.x);
        return glm::vec3(-half_width * round.y, p.y, -p.x);
      },
      true);
}

/// Makes the locks along the crest, thin and serrated.
Mesh make_mane() {
  const glm::vec2 crest[] = {{-0.240F, 0.42F}, {-0.270F, 0.55F}, {-0.255F, 0.70F}, {-0.205F, 0.84F},
                             {-0.125F, 0.96F}, {-0.030F, 1.03F}, {0.060F, 1.03F}};
  const std::vector<glm::vec2> line = smoothed(std::span<const glm::vec2>(crest), 3);
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
  if (detail.share >= 0.5) append(horse, make_mane());
  const std::uint32_t sides = detail.cells(8, 4);
  for (const float side : {-1.0F, 1.0F}) {
    const glm::vec2 ear[] = {{0.020F, 0}, {0.042F, 0.045F}, {0.036F, 0.09F}, {0, 0.165F}};
    append(horse, transformed(make_lathe("", ear, sides), placed({side * 0.062F, 1.0F, 0.02F})));
    const Outline eye = Outline({0, -0.028F}).round({0, 0}, 0.028F, -0.25, 0.25);
    append(horse, transformed(make_lathe("", simplified(eye.points(), detail.cells(6, 4)), sides),
                              placed({side * 0.105F, 0.90F, -0.135F})));
    append(horse, transformed(make_lathe("", simplified(eye.points(), detail.cells(6, 4)), sides),
                              placed({side * 0.06F, 0.625F, -0.35F}, 0, glm::vec3(0.8F))));
  }
  return horse;
}

}  // namespace traces::chess
