#include "traces/scenes/car/wheel.h"

#include <utility>
#include <vector>

#include "traces/scenes/car/body.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/modelling/turned.h"

namespace traces::car {
namespace {

/// Turns a mesh from the y axis to the z axis.
Mesh laid(Mesh mesh) {
  return transformed(std::move(mesh), glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0),
                                                glm::vec4(0, 0, 0, 1)));
}

std::uint32_t segments(const Detail& detail) { return detail.cells(48, 12); }

}  // namespace

Mesh make_tyre(const Detail& detail) {
  Outline o({0.232F, -0.095F});
  o.line(0.240F, -0.108F).arc(0.318F, -0.112F, 0.012F).arc(kWheel, -0.088F, 0.006F);
  for (const float groove : {-0.05F, 0.0F, 0.05F}) {
    o.line(kWheel, groove - 0.008F).line(kWheel - 0.009F, groove - 0.005F);
    o.line(kWheel - 0.009F, groove + 0.005F).line(kWheel, groove + 0.008F);
  }
  o.line(kWheel, 0.088F).arc(0.318F, 0.112F, 0.006F).arc(0.240F, 0.108F, 0.012F).line(0.232F, 0.095F);
  Mesh tyre = laid(make_lathe("tyre", simplified(o.points(), detail.cells(26, 10)), segments(detail)));
  return tyre;
}

Mesh make_rim(const Detail& detail) {
  // The lip, then back into the barrel: normals towards the axis.
  Outline lip({0.242F, 0.080F});
  lip.arc(0.240F, 0.113F, 0.002F).line(0.234F, 0.116F).line(0.226F, 0.108F).arc(0.212F, 0.075F, -0.004F);
  lip.line(0.205F, -0.02F).line(0.212F, -0.10F);
  Mesh rim = laid(make_lathe("rim", simplified(lip.points(), detail.cells(12, 7)), segments(detail)));
  Outline hub({0.070F, 0.02F});
  hub.line(0.066F, 0.070F).arc(0.040F, 0.086F, 0.004F).line(0.034F, 0.082F).line(0.032F, 0.090F).line(0, 0.092F);
  append(rim, laid(make_lathe("", simplified(hub.points(), detail.cells(9, 6)), detail.cells(24, 8))));
  const std::uint32_t sides = detail.cells(8, 4), steps = detail.cells(5, 2);
  for (int k = 0; k < 5; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const Mesh spoke = make_surface(
          "", sides, steps,
          [&](float s, float t) {
            const double angle = k / 5.0 + side * (0.020 + 0.035 * static_cast<double>(t));
            const glm::vec2 out = on_circle(angle), across(-out.y, out.x), round = on_circle(static_cast<double>(s));
            const float radius = 0.045F + 0.172F * t;
            const glm::vec2 p = out * radius + across * ((0.017F - 0.004F * t) * round.x);
            return glm::vec3(p, 0.072F + 0.026F * t * t + 0.014F * round.y);
          },
          true);
      append(rim, spoke);
    }
    const Outline bolt = Outline({0.010F, 0}).line(0.010F, 0.012F).line(0, 0.014F);
    const glm::vec2 at = 0.052F * on_circle(k / 5.0 + 0.1);
    append(rim, transformed(laid(make_lathe("", bolt.points(), 6)), placed({at, 0.074F})));
  }
  return rim;
}

Mesh make_brake_disc(const Detail& detail) {
  const Outline o = Outline({0, -0.012F})
                        .line(0.17F, -0.012F)
                        .line(0.17F, 0.012F)
                        .line(0.09F, 0.012F)
                        .line(0.085F, 0.045F)
                        .line(0, 0.045F);
  return laid(make_lathe("brake disc", o.points(), detail.cells(32, 10)));
}

Mesh make_caliper(const Detail& detail) {
  const std::uint32_t steps = detail.cells(8, 3);
  std::vector<glm::vec2> outline;
  for (const float radius : {0.19F, 0.12F}) {
    for (std::uint32_t i = 0; i <= steps; ++i) {
      const double share = static_cast<double>(radius > 0.15F ? i : steps - i) / steps;
      outline.push_back(radius * on_circle(0.39 + 0.19 * share));
    }
  }
  Mesh caliper = transformed(make_extrusion("caliper", outline, 0.07F), placed({0, 0, -0.03F}));
  return caliper;
}

}  // namespace traces::car
