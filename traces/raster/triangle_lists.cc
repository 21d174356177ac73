#include "traces/raster/triangle_lists.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "sim/error.h"

namespace traces {
namespace {

/// Limit of list entries (chosen): one gigabyte.
constexpr std::uint64_t kMostEntries = 1U << 28;

}  // namespace

TriangleLists::TriangleLists(const RasterGeometry& geometry, const RasterView& view, double near, std::uint32_t side)
    : geometry_(geometry),
      view_(view),
      near_(near),
      side_(side),
      across_((view.width() + side - 1) / side),
      down_((view.height() + side - 1) / side),
      begin_(std::size_t{count()} + 1) {
  const auto triangles = static_cast<std::uint32_t>(geometry.triangles.size());
  std::uint64_t entries = 0;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    each_of(t, [&](std::uint32_t list) {
      begin_[list + 1] += 1;
      entries += 1;
    });
    if (entries > kMostEntries) {
      throw sim::InputError(
          fmt::format("render.primary: raster: lists of triangles take more than {} entries; allowed: a larger "
                      "render.tile, a smaller resolution, or rays",
                      kMostEntries));
    }
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  entries_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t t = 0; t < triangles; ++t) each_of(t, [&](std::uint32_t list) { entries_[next[list]++] = t; });
}

std::uint32_t TriangleLists::at(const glm::dvec2& point) const {
  const auto part = [&](double pixels, std::uint32_t parts) {
    return pixels <= 0 ? 0U : std::min(parts - 1, static_cast<std::uint32_t>(pixels / side_));
  };
  return part(point.y, down_) * across_ + part(point.x, across_);
}

std::array<Projected, 3> TriangleLists::corners(std::uint32_t triangle) const {
  const auto& v = geometry_.triangles[triangle].vertices;
  return {view_.project(geometry_.vertices[v[0]]), view_.project(geometry_.vertices[v[1]]),
          view_.project(geometry_.vertices[v[2]])};
}

}  // namespace traces
