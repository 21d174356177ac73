#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace traces {

/// A pinhole camera. Pixel position (x, y), from the top left corner, has direction corner + x * right + y * down.
struct PictureCamera {
  glm::vec3 origin{0}, corner{0}, right{0}, down{0};
  std::uint32_t width = 0, height = 0;
};

/// A projected point (x, y, w): (x / w, y / w) is its pixel position and w its depth. Depth is measured along the
/// viewing direction and is 1 in the plane of PictureCamera::corner.
using Projected = glm::dvec3;

/// Projects points from world space to the picture.
class RasterView {
 public:
  explicit RasterView(const PictureCamera& camera);

  Projected project_point(const glm::dvec3& point) const { return to_picture_ * (point - origin_); }
  /// Projects a ray from the eye: returns its pixel position and the depth per unit of its length.
  Projected project_direction(const glm::vec3& direction) const { return to_picture_ * glm::dvec3(direction); }
  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }

 private:
  glm::dvec3 origin_;
  glm::dmat3 to_picture_;
  std::uint32_t width_, height_;
};

/// A rectangle of pixels of the picture, both ends included.
struct PictureBox {
  glm::dvec2 low{0}, high{0};
};

/// The homogeneous edge functions of a triangle (Olano & Greer 1997). They find which samples the triangle covers
/// without clipping, even if a vertex is close to the eye or behind it. Front and back faces are rasterised.
///
/// A sample exactly on an edge belongs to the triangle to the right of that edge, or below it if the edge is
/// horizontal. Triangles that share an edge compute the same value for it, so the sample is covered exactly once.
class EdgeFunctions {
 public:
  /// Prepares a triangle. Returns false if it has no area in the picture or a vertex that is not finite.
  bool set_triangle(const std::array<Projected, 3>& vertices);

  /// True if the corners of the triangle appear in clockwise order.
  bool is_clockwise() const { return is_clockwise_; }
  bool covers_point(const glm::dvec2& at) const;
  /// Returns the depth of the triangle at a point that it covers.
  double depth_at(const glm::dvec2& at) const {
    return determinant_ / (edge_value(0, at) + edge_value(1, at) + edge_value(2, at));
  }
  /// A conservative test: returns false only if the triangle covers no point of the box.
  bool may_touch(const PictureBox& box) const;

 private:
  double edge_value(std::size_t edge, const glm::dvec2& at) const {
    return edges_[edge].x * at.x + edges_[edge].y * at.y + edges_[edge].z;
  }

  std::array<glm::dvec3, 3> edges_{};  ///< functions of pixel position; each is positive inside the triangle
  double determinant_ = 0;
  bool is_clockwise_ = false;
};

/// Bounds of the visible part of a triangle, after clipping at the near plane.
struct RasterBounds {
  PictureBox box;      ///< contains all covered pixels, including a margin for rounding
  double nearest = 0;  ///< depth of the nearest point of the triangle
};
bool bounds_of(const std::array<Projected, 3>& vertices, double near, RasterBounds& bounds);

}  // namespace traces
