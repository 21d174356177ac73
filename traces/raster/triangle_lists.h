#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "traces/accel/memory_image.h"
#include "traces/raster/raster_view.h"

namespace traces {

/// The scene as the rasteriser's input: all triangles in world space, in the order of the memory image, one instance
/// after the other. Triangles share vertices with bit-identical positions, numbered in order of first use.
struct RasterGeometry {
  struct Triangle {
    std::array<std::uint32_t, 3> vertices{};
    std::uint32_t index = 0;         ///< index of the triangle in the memory image
    std::uint32_t instance = kNone;  ///< index of the instance in two-level images
    std::uint32_t missing = 0;       ///< culled face in world space: kNoClockwise, kNoCounterClockwise or 0
  };
  std::vector<glm::dvec3> vertices;
  std::vector<Triangle> triangles;
};

RasterGeometry raster_geometry(const MemoryImage& image);

/// For each screen region, the list of triangles that may be visible in it. Regions are squares in row order. A
/// triangle is in the list of each region that its bounds overlap and none of its edges excludes, unless its visible
/// face is culled. Lists are stored one after the other, each in the order of triangles.
class TriangleLists {
 public:
  /// `near` is the depth of the near plane, `side` the side of a screen region in pixels. `geometry` and `view` must
  /// outlive the lists.
  TriangleLists(const RasterGeometry& geometry, const RasterView& view, double near, std::uint32_t side);

  std::uint32_t list_count() const { return across_ * down_; }
  std::uint32_t entry_count() const { return static_cast<std::uint32_t>(entries_.size()); }
  /// Returns the number of the list whose screen region contains a point of the picture.
  std::uint32_t list_number_at(const glm::dvec2& point) const;
  std::span<const std::uint32_t> triangle_list(std::uint32_t number) const {
    return std::span(entries_).subspan(begin_[number], begin_[number + 1] - begin_[number]);
  }
  /// Returns the index of the first entry of list `number` among the entries of all lists.
  std::uint32_t first_entry(std::uint32_t number) const { return begin_[number]; }
  /// Calls `f(list)` for each list that contains the triangle, in ascending order.
  template <class F>
  void for_each_list(std::uint32_t triangle, F&& f) const {
    for_each_list(project_corners(triangle), geometry_.triangles[triangle].missing, f);
  }

 private:
  std::array<Projected, 3> project_corners(std::uint32_t triangle) const;
  template <class F>
  void for_each_list(const std::array<Projected, 3>& corners, std::uint32_t missing, F&& f) const;

  const RasterGeometry& geometry_;
  const RasterView& view_;
  const double near_;
  const std::uint32_t side_, across_, down_;
  std::vector<std::uint32_t> begin_, entries_;
};

template <class F>
void TriangleLists::for_each_list(const std::array<Projected, 3>& corners, std::uint32_t missing, F&& f) const {
  RasterBounds bounds;
  EdgeFunctions edges;
  if (!bounds_of(corners, near_, bounds) || !edges.set_triangle(corners)) return;
  if ((missing & (edges.is_clockwise() ? kNoClockwise : kNoCounterClockwise)) != 0) return;
  const auto& [low, high] = bounds.box;
  if (!(high.x >= 0 && high.y >= 0 && low.x <= view_.width() && low.y <= view_.height())) return;
  const auto part = [&](double pixels, std::uint32_t parts) {
    const double at = pixels / side_;
    return at <= 0 ? 0U : at >= parts ? parts - 1 : static_cast<std::uint32_t>(at);
  };
  const std::uint32_t x0 = part(low.x, across_), x1 = part(high.x, across_);
  const std::uint32_t y0 = part(low.y, down_), y1 = part(high.y, down_);
  for (std::uint32_t y = y0; y <= y1; ++y) {
    for (std::uint32_t x = x0; x <= x1; ++x) {
      const glm::dvec2 corner = glm::dvec2(x, y) * static_cast<double>(side_);
      if (edges.may_touch({corner, corner + static_cast<double>(side_)})) f(y * across_ + x);
    }
  }
}

}  // namespace traces
