#include "traces/raster/raster_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace traces {

RasterView::RasterView(const PictureCamera& camera)
    : origin_(camera.origin),
      to_picture_(
          glm::inverse(glm::dmat3(glm::dvec3(camera.right), glm::dvec3(camera.down), glm::dvec3(camera.corner)))),
      width_(camera.width),
      height_(camera.height) {}

bool EdgeFunctions::set_triangle(const std::array<Projected, 3>& v) {
  edges_ = {glm::cross(v[1], v[2]), glm::cross(v[2], v[0]), glm::cross(v[0], v[1])};
  determinant_ = glm::dot(v[0], edges_[0]);
  if (determinant_ == 0 || !std::isfinite(determinant_)) return false;
  for (const glm::dvec3& edge : edges_) {
    if (!std::isfinite(edge.x + edge.y + edge.z)) return false;
  }
  is_clockwise_ = determinant_ > 0;
  if (determinant_ < 0) {
    determinant_ = -determinant_;
    for (glm::dvec3& edge : edges_) edge = -edge;
  }
  return true;
}

bool EdgeFunctions::covers_point(const glm::dvec2& at) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const double e = edge_value(i, at);
    const bool owns = edges_[i].x > 0 || (edges_[i].x == 0 && edges_[i].y > 0);
    if (!(e > 0 || (e == 0 && owns))) return false;
  }
  return true;
}

bool EdgeFunctions::may_touch(const PictureBox& box) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 most(edges_[i].x > 0 ? box.high.x : box.low.x, edges_[i].y > 0 ? box.high.y : box.low.y);
    if (edge_value(i, most) < 0) return false;
  }
  return true;
}

bool bounds_of(const std::array<Projected, 3>& vertices, double near, RasterBounds& bounds) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bounds = {{glm::dvec2(kInfinity), glm::dvec2(-kInfinity)}, kInfinity};
  const auto add = [&](const Projected& p) {
    const glm::dvec2 at = glm::dvec2(p) / p.z;
    bounds.box = {glm::min(bounds.box.low, at), glm::max(bounds.box.high, at)};
    bounds.nearest = std::min(bounds.nearest, p.z);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Projected &a = vertices[i], &b = vertices[(i + 1) % 3];
    if (!std::isfinite(a.x + a.y + a.z)) return false;
    if (a.z >= near) add(a);
    if ((a.z >= near) != (b.z >= near)) {
      const double part = (near - a.z) / (b.z - a.z);
      add({a.x + (b.x - a.x) * part, a.y + (b.y - a.y) * part, near});
    }
  }
  // Enlarges the box by rounding errors: the edge functions may cover a sample just outside the projected corners.
  constexpr double kRounding = 1e-12;
  const glm::dvec2 slack = kRounding * (1.0 + glm::max(glm::abs(bounds.box.low), glm::abs(bounds.box.high)));
  bounds.box = {bounds.box.low - slack, bounds.box.high + slack};
  return bounds.nearest < kInfinity;
}

}  // namespace traces
