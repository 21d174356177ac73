#include "tools/studies/sweep/launch/slurm_queue.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "tools/host/interrupt.h"
#include "tools/studies/sweep/launch/slurm_client.h"

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostListBytes = std::uint64_t{1} << 30;

std::vector<SlurmTask> tasks_of(const SweepFolder& folder) { return slurm::tasks_of(fs::canonical(folder.path())); }

std::vector<std::string> lines_of(const fs::path& file) {
  std::istringstream text(sim::read_file(file, kMostListBytes));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace

SlurmQueue queue_of(const SweepFolder& folder) {
  SlurmQueue queue;
  for (const SlurmTask& task : tasks_of(folder)) {
    const bool waits = task.state == "PENDING";
    (waits ? queue.waiting : queue.running) += 1;
    if (waits && task.reason != "None") queue.reasons.insert(task.reason);
    queue.jobs.insert(task.job);
  }
  return queue;
}

std::set<std::string> queued_points(const SweepFolder& folder) {
  std::map<fs::path, std::vector<std::string>> lists;
  std::set<std::string> ids;
  for (const SlurmTask& task : tasks_of(folder)) {
    const auto [list, is_new] = lists.try_emplace(task.script);
    if (is_new) list->second = lines_of(fs::path(task.script).replace_extension(".txt"));
    if (task.index >= list->second.size()) continue;
    std::istringstream words(list->second[task.index]);
    for (std::string id; words >> id;) ids.insert(id);
  }
  return ids;
}

bool was_submitted(const SweepFolder& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename();
    if (name.starts_with("submit-") && name.ends_with(".sh")) return true;
  }
  return false;
}

SlurmQueue cancel_jobs(const SweepFolder& folder) {
  constexpr double kPatience = 60;  // s
  const SlurmQueue queue = queue_of(folder);
  slurm::cancel(queue.jobs);
  const sim::HostClock::time_point begin = sim::HostClock::now();
  while (!queue.jobs.empty() && sim::seconds_since(begin) < kPatience && !queue_of(folder).jobs.empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  return queue;
}

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
