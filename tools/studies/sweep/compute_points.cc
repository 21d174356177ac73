#include <algorithm>
#include <iterator>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/exit_code.h"
#include "tools/host/interrupt.h"
#include "tools/studies/sweep/launch/local_launcher.h"
#include "tools/studies/sweep/store/folder.h"
#include "tools/studies/sweep/sweep.h"

namespace tools {
namespace {

namespace fs = std::filesystem;
using sweep::Point;
using sweep::SweepFolder;

/// The ids of a list, by line, or of the sweep, each by itself, if there is none. Slices stand for points that
/// are cut.
std::vector<std::vector<std::string>> listed(const std::vector<Point>& points, const fs::path& list) {
  std::vector<std::vector<std::string>> ids;
  if (list.empty()) {
    for (const Point& point : points) {
      if (!point.is_cut()) ids.push_back({point.id});
      for (const Point& slice : slices_of(point)) ids.push_back({slice.id});
    }
    return ids;
  }
  std::istringstream lines(sim::read_file(list, std::uint64_t{1} << 30));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    ids.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  return ids;
}

/// The points of a chunk of lines.
std::vector<Point> chosen(const SweepFolder& folder, const PointOptions& options) {
  const std::vector<Point> all = folder.points();
  const std::vector<std::vector<std::string>> lines = listed(all, options.list);
  const std::uint64_t chunks = (lines.size() + options.chunk - 1) / options.chunk;
  if (options.index >= chunks) {
    throw sim::InputError(
        fmt::format("--index {}: there are {} chunks of {} points", options.index, chunks, options.chunk));
  }
  std::map<std::string, Point> by_id;
  for (const Point& point : all) {
    by_id.emplace(point.id, point);
    for (const Point& slice : slices_of(point)) by_id.emplace(slice.id, slice);
  }
  const std::size_t begin = options.index * options.chunk;
  const std::size_t end = begin + std::min<std::size_t>(options.chunk, lines.size() - begin);
  std::vector<Point> points;
  for (std::size_t l = begin; l < end; ++l) {
    for (const std::string& id : lines[l]) {
      const auto found = by_id.find(id);
      if (found == by_id.end()) {
        throw sim::InputError(fmt::format("{}:{}: '{}' is no point of this sweep",
                                          sim::printable(options.list.string()), l + 1, sim::printable(id)));
      }
      points.push_back(found->second);
    }
  }
  return points;
}

}  // namespace

int compute_points(const PointOptions& options) {
  const SweepFolder folder = SweepFolder::open(options.folder);
  const std::vector<Point> points = chosen(folder, options);
  const HoldInterrupts hold;
  sweep::LocalLauncher launcher(folder.store(), {.jobs = options.jobs,
                                                 .threads = 1,
                                                 .retry_failed = options.retry_failed,
                                                 .keep_streams = true,
                                                 .log = folder.log()});
  const sweep::BatchEnd end = launcher.run(points);
  return end.count(sweep::Fate::kFailed) != 0 ? kCheckFailed : kGood;
}

}  // namespace tools
