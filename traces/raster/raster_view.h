#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace traces {

/// A pinhole camera's picture: its point (x, y), in pixels from the top left corner, is seen along
/// corner + x * right + y * down.
struct PictureCamera {
  glm::vec3 origin{0}, corner{0}, right{0}, down{0};
  std::uint32_t width = 0, height = 0;
};

/// A point of space as the picture sees it: (x / w, y / w) in pixels, w its depth. Depth is 1 in the plane of
/// PictureCamera::corner and grows with the way along the view.
using Projected = glm::dvec3;

/// Where space lies in a picture.
class RasterView {
 public:
  explicit RasterView(const PictureCamera& camera);

  Projected project(const glm::dvec3& point) const { return to_picture_ * (point - origin_); }
  /// The point of the picture, and depth per length, of a ray from the eye.
  Projected of_ray(const glm::vec3& direction) const { return to_picture_ * glm::dvec3(direction); }
  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }

 private:
  glm::dvec3 origin_;
  glm::dmat3 to_picture_;
  std::uint32_t width_, height_;
};

/// A rectangle of the picture, in pixels, both ends belonging to it.
struct PictureBox {
  glm::dvec2 low{0}, high{0};
};

/// A triangle ready to be asked what it covers: homogeneous edge functions (Olano & Greer 1997), so that nothing need
/// be clipped to find coverage, however near to the eye or far behind it a vertex lies. Both sides are drawn.
///
/// Samples on an edge belong to the triangle right of it, or below it if it is level, as two that share it name it by
/// the same numbers; so each is covered once.
class EdgeFunctions {
 public:
  /// False, and nothing to ask, for a triangle without area in the picture or with a vertex that is no finite number.
  bool set(const std::array<Projected, 3>& vertices);

  /// Whether its corners are seen to run clockwise.
  bool is_clockwise() const { return is_clockwise_; }
  bool covers(const glm::dvec2& at) const;
  /// Depth at a point that it covers.
  double depth(const glm::dvec2& at) const { return determinant_ / (value(0, at) + value(1, at) + value(2, at)); }
  /// False if it cannot cover any point of the box.
  bool may_touch(const PictureBox& box) const;

 private:
  double value(std::size_t edge, const glm::dvec2& at) const {
    return edges_[edge].x * at.x + edges_[edge].y * at.y + edges_[edge].z;
  }

  std::array<glm::dvec3, 3> edges_{};  ///< each positive inside
  double determinant_ = 0;
  bool is_clockwise_ = false;
};

/// Bounds of a triangle's visible part, clipped at the near plane; false if there is none.
struct RasterBounds {
  PictureBox box;      ///< holds all that is covered, rounding included
  double nearest = 0;  ///< depth of its nearest point
};
bool bounds_of(const std::array<Projected, 3>& vertices, double near, RasterBounds& bounds);

}  // namespace traces
