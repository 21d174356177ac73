#include "tools/studies/sweep/results/index/collection.h"

#include <algorithm>
#include <limits>

#include "tools/host/parallel.h"

namespace tools::results {
namespace {

constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();

/// A thread's own numbers of metrics, and which of all they are.
struct Reader {
  MetricNames names;
  std::vector<std::uint32_t> global;
};

/// The reader of every point.
std::vector<std::size_t> read_all(const sweep::Store& store, Collection& all, std::vector<Reader>& readers) {
  std::vector<std::size_t> by(all.points.size());
  parallel_for(all.points.size(), readers.size(), [&](std::size_t i, std::size_t reader) {
    all.states[i] = read_point_state(store, all.points[i].id, readers[reader].names);
    by[i] = reader;
  });
  return by;
}

constexpr std::pair<const char*, std::string sweep::Point::*> kSettings[] = {
    {"scene", &sweep::Point::scene},
    {"camera", &sweep::Point::camera},
    {"frames", &sweep::Point::frames},
    {"resolution", &sweep::Point::resolution},
    {"program", &sweep::Point::program},
    {"reference", &sweep::Point::reference},
    {"tile_sampling", &sweep::Point::tile_sampling}};

}  // namespace

Collection collect_points(std::vector<ListedPoint> points, const sweep::Store& store) {
  Collection all;
  all.points = std::move(points);
  all.states.resize(all.points.size());
  const std::size_t cores = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 8);
  std::vector<Reader> readers(std::min(cores, all.points.size()));
  const std::vector<std::size_t> by = read_all(store, all, readers);

  MetricNames names, axes;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    for (const auto& [axis, value] : all.points[i].axes) axes.number_of(axis);
    if (all.states[i].status != Status::kDone) continue;
    Reader& reader = readers[by[i]];
    reader.global.resize(reader.names.names().size(), kUnknown);
    auto& metrics = all.states[i].report.metrics;
    for (auto& [number, value] : metrics) {
      std::uint32_t& global = reader.global[number];
      if (global == kUnknown) global = names.number_of(reader.names.names()[number]);
      if (all.columns.size() <= global) all.columns.resize(global + 1, std::vector<Value>(all.points.size()));
      all.columns[global][i] = std::move(value);
    }
    decltype(all.states[i].report.metrics)().swap(metrics);
  }
  all.metrics = names.names();
  all.axes = axes.names();
  return all;
}

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
