#include "tools/studies/sweep/slurm_tasks.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tools::sweep {

std::vector<std::string> task_lines(const std::vector<const Point*>& points, std::uint64_t chunk) {
  std::vector<std::vector<std::string>> groups;  // ids by recorded work, in the order of the points
  std::map<std::string, std::size_t> group_of;
  for (const Point* point : points) {
    const auto [group, is_new] = group_of.emplace(point->stream.empty() ? point->id : point->stream, groups.size());
    if (is_new) groups.emplace_back();
    groups[group->second].push_back(point->id);
  }
  std::vector<std::vector<std::string>> tasks;
  for (const std::vector<std::string>& group : groups) {
    const bool fits = !tasks.empty() && tasks.back().size() + std::min<std::size_t>(group.size(), chunk) <= chunk;
    if (!fits) tasks.emplace_back();
    for (const std::string& id : group) {
      if (tasks.back().size() == chunk) tasks.emplace_back();
      tasks.back().push_back(id);
    }
  }
  std::vector<std::string> lines;
  for (const std::vector<std::string>& task : tasks) lines.push_back(fmt::format("{}", fmt::join(task, " ")));
  return lines;
}

}  // namespace tools::sweep
