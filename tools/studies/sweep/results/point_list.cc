#include "tools/studies/sweep/results/point_list.h"

#include <algorithm>

namespace tools::results {

namespace {

constexpr std::pair<const char*, std::string sweep::Point::*> kSettings[] = {
    {"scene", &sweep::Point::scene},
    {"camera", &sweep::Point::camera},
    {"frames", &sweep::Point::frames},
    {"resolution", &sweep::Point::resolution},
    {"program", &sweep::Point::program},
    {"reference", &sweep::Point::reference},
    {"tile_sampling", &sweep::Point::tile_sampling}};

}  // namespace

std::vector<ListedPoint> list_points(std::span<const sweep::Point> points) {
  std::vector<ListedPoint> listed;
  for (const sweep::Point& point : points) {
    ListedPoint line{static_cast<std::int64_t>(point.n), point.id, point.axes};
    for (const auto& [name, member] : kSettings) {
      const bool is_axis =
          std::ranges::find(point.axes, name, [](const auto& axis) { return axis.first; }) != point.axes.end();
      if (!is_axis && !(point.*member).empty()) line.axes.emplace_back(name, point.*member);
    }
    listed.push_back(std::move(line));
  }
  return listed;
}

}  // namespace tools::results
