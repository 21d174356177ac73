#include "tools/studies/sweep/launch/slurm_launcher.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <iterator>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/interrupt.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/launch/slurm_client.h"
#include "tools/studies/sweep/launch/slurm_queue.h"

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kTasks = 100;

/// As Slurm's queue shows it.
fs::path true_path(const SweepFolder& folder) { return fs::canonical(folder.path()); }

fs::path list_file(const fs::path& folder, std::uint64_t k) { return folder / fmt::format("submit-{}.txt", k); }
fs::path script_file(const fs::path& folder, std::uint64_t k) { return folder / fmt::format("submit-{}.sh", k); }

/// The first number that no earlier array has.
std::uint64_t next_array(const fs::path& folder) {
  std::uint64_t k = 1;
  while (fs::exists(script_file(folder, k)) || fs::exists(list_file(folder, k))) ++k;
  return k;
}

/// In the name of an output file % begins a pattern.
std::string without_patterns(const std::string& path) {
  std::string out;
  for (const char c : path) out += c == '%' ? std::string("%%") : std::string(1, c);
  return out;
}

void check_arguments(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    // sbatch takes any beginning of a word that is clear.
    const std::string_view word = std::string_view(argument).substr(0, argument.find('='));
    const auto begins = [&](std::string_view option) { return word.size() >= 4 && option.starts_with(word); };
    const bool is_ours = argument.starts_with("-a") || begins("--array") || begins("--wrap") || begins("--parsable");
    if (is_ours || !argument.starts_with('-')) {
      throw sim::InputError(
          fmt::format("argument '{}' for sbatch: allowed: options in one word, such as --time=1:00:00, "
                      "but not --array, --wrap and --parsable (how many tasks there are follows from "
                      "--chunk, how many at a time from --jobs)",
                      sim::printable(argument)));
    }
  }
}

}  // namespace

SlurmLauncher::SlurmLauncher(const SweepFolder& folder, const Options& options)
    : Launcher(folder.store(), options.retry_failed), folder_(folder), options_(options) {
  check_arguments(options.arguments);
}

SlurmLauncher::Submitted SlurmLauncher::submit(std::span<const Point> points) {
  std::vector<const Point*> wanted;
  std::deque<Point> slices;
  std::set<std::string> seen;
  for (const Point& point : points) {
    if (!seen.insert(point.id).second || !is_wanted(point)) continue;
    const std::size_t before = slices.size();
    std::ranges::copy_if(slices_of(point), std::back_inserter(slices),
                         [&](const Point& one) { return is_wanted(one); });
    if (slices.size() == before) wanted.push_back(&point);  // is not cut, or its slices have ended and shall be joined
    for (std::size_t s = before; s < slices.size(); ++s) wanted.push_back(&slices[s]);
    if (slices.size() != before && retry_failed_) forget_failure(point);
  }
  Submitted submitted;
  if (wanted.empty()) return submitted;
  const std::set<std::string> queued = queued_points(folder_);
  submitted.queued = std::erase_if(wanted, [&](const Point* point) { return queued.contains(point->id); });
  if (wanted.empty()) return submitted;
  for (const Point* point : wanted) forget_failure(*point);
  const std::uint64_t chunk = options_.chunk != 0 ? options_.chunk : (wanted.size() + kTasks - 1) / kTasks;
  const std::vector<std::string> lines = task_lines(wanted, chunk);
  const std::uint64_t most = slurm::most_tasks();
  for (std::uint64_t begin = 0; begin < lines.size(); begin += most) {
    submitted.jobs.push_back(
        submit_array(std::span(lines).subspan(begin, std::min<std::uint64_t>(most, lines.size() - begin))));
  }
  submitted.points = wanted.size();
  submitted.tasks = lines.size();
  return submitted;
}

std::string SlurmLauncher::submit_array(std::span<const std::string> lines) {
  const fs::path folder = true_path(folder_);
  const std::uint64_t k = next_array(folder);
  const fs::path list = list_file(folder, k), script = script_file(folder, k);
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  sim::write_file_atomically(list, text);
  sim::write_file_atomically(script, fmt::format("#!/bin/sh\n"
                                                 "exec {} sweep point {} --list {} --index \"$SLURM_ARRAY_TASK_ID\" "
                                                 "--jobs \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
                                                 single_quoted(fs::read_symlink("/proc/self/exe").string()),
                                                 single_quoted(folder.string()), single_quoted(list.string())));
  std::vector<std::string> arguments = {
      fmt::format("--job-name=raywatt-{}", folder.filename().string()),
      fmt::format("--array=0-{}{}", lines.size() - 1, options_.tasks != 0 ? fmt::format("%{}", options_.tasks) : ""),
      "--ntasks=1",
      "--requeue",
      "--open-mode=append",
      fmt::format("--output={}/slurm-%A_%a.log", without_patterns(fs::canonical(folder_.log()).string()))};
  arguments.insert(arguments.end(), options_.arguments.begin(), options_.arguments.end());
  arguments.push_back(script.string());
  try {
    return slurm::submit(arguments);
  } catch (const sim::InputError&) {
    std::error_code ignored;
    fs::remove(script, ignored);
    fs::remove(list, ignored);
    throw;
  }
}

namespace {

using Seconds = std::chrono::duration<double>;

/// Has patience with a controller that is away for a while.
class PatientQueue {
 public:
  explicit PatientQueue(const SweepFolder& folder) : folder_(folder) {}
  bool is_empty() {
    try {
      const bool empty = queue_of(folder_).jobs.empty();
      answered_ = sim::HostClock::now();
      return empty;
    } catch (const sim::IoError&) {
      if (sim::seconds_since(answered_) > kPatience) throw;
      return false;
    }
  }

 private:
  static constexpr double kPatience = 300;  // s
  const SweepFolder& folder_;
  sim::HostClock::time_point answered_ = sim::HostClock::now();
};

void sleep_unless_interrupted(double seconds) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  while (!is_interrupted() && sim::seconds_since(begin) < seconds) std::this_thread::sleep_for(Seconds(0.05));
}

/// Logs of tasks that had nothing to say.
void remove_empty_logs(const fs::path& log) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(log, ignored)) {
    const bool is_ours = entry.path().filename().string().starts_with("slurm-");
    if (is_ours && entry.is_regular_file(ignored) && entry.file_size(ignored) == 0) fs::remove(entry.path(), ignored);
  }
}

}  // namespace

BatchEnd SlurmLauncher::play(std::span<const Point> points, const Watch& watch) {
  constexpr double kShortestPause = 0.5, kLongestPause = 15, kSettle = 2;  // s
  BatchEnd end;
  end.fates.assign(points.size(), Fate::kMissing);
  std::vector<std::size_t> open;
  const auto look = [&](Fate good) {
    std::erase_if(open, [&](std::size_t p) {
      const std::string& id = points[p].id;
      if (store_.state(id) == Store::State::kGood) {
        end.fates[p] = good;
      } else if (store_.failure(id)) {
        end.fates[p] = Fate::kFailed;
      } else {
        return false;
      }
      watch(p, end.fates[p]);
      return true;
    });
  };
  const sim::HostClock::time_point begin = sim::HostClock::now();
  submit(points);
  for (std::size_t p = 0; p < points.size(); ++p) open.push_back(p);
  look(Fate::kFound);
  PatientQueue queue(folder_);
  bool settled = false;  // what tasks wrote last may show late on file systems that are shared
  while (!open.empty() && !is_interrupted()) {
    const bool is_empty = queue.is_empty();
    look(Fate::kComputed);
    if (open.empty() || (is_empty && settled)) break;
    settled = is_empty;
    sleep_unless_interrupted(is_empty ? kSettle
                                      : std::clamp(sim::seconds_since(begin) / 20, kShortestPause, kLongestPause));
  }
  end.seconds = sim::seconds_since(begin);
  end.interrupted = is_interrupted();
  if (end.interrupted) return end;
  remove_empty_logs(folder_.log());
  for (const Point& point : points) {
    if (!point.stream.empty()) store_.remove_stream(point.stream);  // that tasks have left for each other
  }
  return end;
}

}  // namespace tools::sweep
