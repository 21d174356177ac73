#include "tools/studies/sweep/launch/slurm.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"

extern char** environ;

namespace tools::sweep {
namespace {

namespace fs = std::filesystem;

/// A task of a job array in the queue.
struct SlurmTask {
  std::string job;          ///< id of the array
  std::uint64_t index = 0;  ///< index of the task in its array
  std::string state;        ///< state as Slurm prints it: PENDING, RUNNING, COMPLETING, ...
  std::string reason;       ///< why it waits
  fs::path script;
};

using Words = std::vector<std::string>;

constexpr std::size_t kMostErrorText = 2000;  // bytes

/// The output of a command and its exit code.
struct CommandOutput {
  int exit = 0;
  std::string out, err;
};

/// An anonymous file for the output of a command.
class Sink {
 public:
  Sink() : file_(::memfd_create("output", MFD_CLOEXEC)) {
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), "no memory for the output of a command");
  }
  ~Sink() { ::close(file_); }
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;

  int file() const { return file_; }
  std::string read_text() const {
    std::string text;
    std::array<char, 65536> part{};
    for (ssize_t size = 0; (size = ::pread(file_, part.data(), part.size(), static_cast<off_t>(text.size()))) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

 private:
  int file_;
};

/// Returns the environment without the variables that make squeue and scancel leave out jobs or ask for confirmation.
std::vector<char*> command_environment() {
  std::vector<char*> variables;
  for (char** v = environ; *v != nullptr; ++v) {
    const std::string_view variable = *v;
    if (!variable.starts_with("SQUEUE_") && !variable.starts_with("SCANCEL_")) variables.push_back(*v);
  }
  variables.push_back(nullptr);
  return variables;
}

/// Runs a command in a process group of its own, so that Ctrl-C does not reach it, with default signal handlers.
CommandOutput run_command(const Words& words) {
  const Sink out, err;
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, out.file(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, err.file(), STDERR_FILENO);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t defaults;
  ::sigemptyset(&defaults);
  for (const int signal : kSignalsOfWrites) ::sigaddset(&defaults, signal);
  ::posix_spawnattr_setsigdefault(&attributes, &defaults);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  const int error =
      ::posix_spawnp(&process, arguments[0], &files, &attributes, arguments.data(), command_environment().data());
  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    throw sim::InputError(fmt::format(
        "{} cannot be started: {}; --launcher slurm is for hosts from which jobs are handed in, others have local",
        words[0], std::generic_category().message(error)));
  }
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), out.read_text(), err.read_text()};
}

/// Returns the error of a command on one line: "sbatch: error: ...".
std::string error_text(const Words& words, const CommandOutput& said) {
  std::string text;
  std::istringstream lines(said.err);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) text += (text.empty() ? "" : "; ") + line;
  }
  if (text.empty()) text = fmt::format("{} ended with {} and printed nothing", words[0], said.exit);
  return sim::printable(text, kMostErrorText);
}

template <class Error>
std::string output_of(const Words& words) {
  const CommandOutput said = run_command(words);
  if (said.exit != 0) throw Error(error_text(words, said));
  return said.out;
}

/// Returns the queued tasks of this user whose script is in this folder. Throws IoError if squeue fails.
std::vector<SlurmTask> queued_tasks(const fs::path& folder) {
  // The name of the script may contain any character, so it is the last field.
  std::istringstream lines(
      output_of<sim::IoError>({"squeue", "--me", "--noheader", "--array", "--format=%F|%K|%T|%r|%N|%o"}));
  std::vector<SlurmTask> tasks;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    SlurmTask task;
    std::string index, node, script;
    for (std::string* field : {&task.job, &index, &task.state, &task.reason, &node}) {
      std::getline(fields, *field, '|');
    }
    std::getline(fields, script);
    task.script = script;
    const auto [end, error] = std::from_chars(index.data(), index.data() + index.size(), task.index);
    if (error == std::errc() && task.script.parent_path() == folder) tasks.push_back(std::move(task));
  }
  return tasks;
}

/// Returns the largest number of tasks of an array: MaxArraySize. Throws IoError.
std::uint64_t max_array_size() {
  constexpr std::string_view kKey = "MaxArraySize";
  std::istringstream lines(output_of<sim::IoError>({"scontrol", "show", "config"}));
  for (std::string line; std::getline(lines, line);) {
    std::uint64_t most = 0;
    const std::size_t equals = line.find('=');
    if (!line.starts_with(kKey) || equals == std::string::npos) continue;
    std::istringstream(line.substr(equals + 1)) >> most;
    if (most != 0) return most;
    throw sim::InputError("this Slurm has no job arrays: its MaxArraySize is 0");
  }
  throw sim::IoError("scontrol show config has no MaxArraySize");
}

/// Submits a job; returns its id. Throws InputError if Slurm refuses it.
std::string submit_job(const Words& arguments) {
  Words words = {"sbatch", "--parsable"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::string out = output_of<sim::InputError>(words);
  return out.substr(0, out.find_first_of(";\n"));  // "12" or "12;cluster"
}

/// Cancels jobs. Throws IoError if Slurm refuses.
void cancel_jobs(const std::set<std::string>& jobs) {
  if (jobs.empty()) return;
  Words words = {"scancel"};
  words.insert(words.end(), jobs.begin(), jobs.end());
  output_of<sim::IoError>(words);
}

constexpr std::uint64_t kMostListBytes = std::uint64_t{1} << 30;

/// The tasks of a sweep in the queue of Slurm.
struct SlurmQueue {
  std::uint64_t running = 0, waiting = 0;  ///< tasks
  std::set<std::string> jobs;              ///< ids of the job arrays of these tasks
  std::set<std::string> reasons;           ///< why tasks wait
};

/// Returns the path of the sweep's folder without symbolic links, as squeue prints it.
fs::path canonical_path(const SweepFolder& folder) { return fs::canonical(folder.path()); }

std::vector<std::string> read_lines(const fs::path& file) {
  std::istringstream text(sim::read_file(file, kMostListBytes));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

SlurmQueue read_queue(const SweepFolder& folder) {
  SlurmQueue queue;
  for (const SlurmTask& task : queued_tasks(canonical_path(folder))) {
    const bool waits = task.state == "PENDING";
    (waits ? queue.waiting : queue.running) += 1;
    if (waits && task.reason != "None") queue.reasons.insert(task.reason);
    queue.jobs.insert(task.job);
  }
  return queue;
}

/// Returns the ids of the points whose tasks are in the queue.
std::set<std::string> queued_points(const SweepFolder& folder) {
  std::map<fs::path, std::vector<std::string>> lists;
  std::set<std::string> ids;
  for (const SlurmTask& task : queued_tasks(canonical_path(folder))) {
    const auto [list, is_new] = lists.try_emplace(task.script);
    if (is_new) list->second = read_lines(fs::path(task.script).replace_extension(".txt"));
    if (task.index >= list->second.size()) continue;
    std::istringstream words(list->second[task.index]);
    for (std::string id; words >> id;) ids.insert(id);
  }
  return ids;
}

/// True if points of the sweep were ever submitted.
bool was_submitted(const SweepFolder& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename();
    if (name.starts_with("submit-") && name.ends_with(".sh")) return true;
  }
  return false;
}

/// Cancels the jobs of the sweep and waits until they have ended. Returns the queue as it was before.
SlurmQueue cancel_queue(const SweepFolder& folder) {
  constexpr double kPatience = 60;  // s
  const SlurmQueue queue = read_queue(folder);
  cancel_jobs(queue.jobs);
  const sim::HostClock::time_point begin = sim::HostClock::now();
  while (!queue.jobs.empty() && sim::seconds_since(begin) < kPatience && !read_queue(folder).jobs.empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  return queue;
}

}  // namespace

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

namespace {

constexpr std::uint64_t kTasks = 100;

fs::path list_file(const fs::path& folder, std::uint64_t k) { return folder / fmt::format("submit-{}.txt", k); }
fs::path script_file(const fs::path& folder, std::uint64_t k) { return folder / fmt::format("submit-{}.sh", k); }

/// Returns the lowest number that no earlier job array of the sweep has.
std::uint64_t next_array_number(const fs::path& folder) {
  std::uint64_t k = 1;
  while (fs::exists(script_file(folder, k)) || fs::exists(list_file(folder, k))) ++k;
  return k;
}

/// Escapes the character %, which begins a pattern in Slurm's names of output files.
std::string escape_patterns(const std::string& path) {
  std::string out;
  for (const char c : path) out += c == '%' ? std::string("%%") : std::string(1, c);
  return out;
}

void check_arguments(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    // sbatch accepts any unambiguous beginning of an option.
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

SlurmLauncher::Submitted SlurmLauncher::submit_points(std::span<const Point> points) {
  std::vector<const Point*> wanted;
  std::deque<Point> slices;
  std::set<std::string> seen;
  for (const Point& point : points) {
    if (!seen.insert(point.id).second || !needs_computing(store_.status_of(point.id))) continue;
    const std::size_t before = slices.size();
    std::ranges::copy_if(slices_of(point), std::back_inserter(slices),
                         [&](const Point& one) { return needs_computing(store_.status_of(one.id)); });
    if (slices.size() == before) wanted.push_back(&point);  // not cut, or its slices only have to be joined
    for (std::size_t s = before; s < slices.size(); ++s) wanted.push_back(&slices[s]);
    if (slices.size() != before && retry_failed_) remove_failure(point);
  }
  Submitted submitted;
  if (wanted.empty()) return submitted;
  const std::set<std::string> queued = queued_points(folder_);
  submitted.queued = std::erase_if(wanted, [&](const Point* point) { return queued.contains(point->id); });
  if (wanted.empty()) return submitted;
  for (const Point* point : wanted) remove_failure(*point);
  const std::uint64_t chunk = options_.chunk != 0 ? options_.chunk : (wanted.size() + kTasks - 1) / kTasks;
  const std::vector<std::string> lines = task_lines(wanted, chunk);
  const std::uint64_t most = max_array_size();
  for (std::uint64_t begin = 0; begin < lines.size(); begin += most) {
    submitted.jobs.push_back(
        submit_array(std::span(lines).subspan(begin, std::min<std::uint64_t>(most, lines.size() - begin))));
  }
  submitted.points = wanted.size();
  submitted.tasks = lines.size();
  return submitted;
}

std::string SlurmLauncher::submit_array(std::span<const std::string> lines) {
  const fs::path folder = canonical_path(folder_);
  const std::uint64_t k = next_array_number(folder);
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
      fmt::format("--output={}/slurm-%A_%a.log", escape_patterns(fs::canonical(folder_.log_folder()).string()))};
  arguments.insert(arguments.end(), options_.arguments.begin(), options_.arguments.end());
  arguments.push_back(script.string());
  try {
    return submit_job(arguments);
  } catch (const sim::InputError&) {
    std::error_code ignored;
    fs::remove(script, ignored);
    fs::remove(list, ignored);
    throw;
  }
}

namespace {

using Seconds = std::chrono::duration<double>;

/// Reads the queue of Slurm. Tolerates that Slurm does not answer for a while.
class PatientQueue {
 public:
  explicit PatientQueue(const SweepFolder& folder) : folder_(folder) {}
  bool is_empty() {
    try {
      const bool empty = read_queue(folder_).jobs.empty();
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

/// Removes the empty logs of tasks.
void remove_empty_logs(const fs::path& log) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(log, ignored)) {
    const bool is_ours = entry.path().filename().string().starts_with("slurm-");
    if (is_ours && entry.is_regular_file(ignored) && entry.file_size(ignored) == 0) fs::remove(entry.path(), ignored);
  }
}

}  // namespace

BatchResult SlurmLauncher::run_batch(std::span<const Point> points, const PointWatch& watch) {
  constexpr double kShortestPause = 0.5, kLongestPause = 15, kSettle = 2;  // s
  BatchResult end;
  end.statuses.assign(points.size(), PointStatus::kMissing);
  std::vector<std::size_t> open;
  const auto update = [&](PointStatus if_done) {
    std::erase_if(open, [&](std::size_t p) {
      const PointStatus status = store_.status_of(points[p].id);
      if (!is_done(status) && status != PointStatus::kFailed) return false;
      end.statuses[p] = is_done(status) ? if_done : status;
      watch(p, end.statuses[p]);
      return true;
    });
  };
  const sim::HostClock::time_point begin = sim::HostClock::now();
  submit_points(points);
  for (std::size_t p = 0; p < points.size(); ++p) open.push_back(p);
  update(PointStatus::kDone);
  PatientQueue queue(folder_);
  bool settled = false;  // results may appear late on shared file systems
  while (!open.empty() && !is_interrupted()) {
    const bool is_empty = queue.is_empty();
    update(PointStatus::kComputed);
    if (open.empty() || (is_empty && settled)) break;
    settled = is_empty;
    sleep_unless_interrupted(is_empty ? kSettle
                                      : std::clamp(sim::seconds_since(begin) / 20, kShortestPause, kLongestPause));
  }
  end.seconds = sim::seconds_since(begin);
  end.interrupted = is_interrupted();
  if (end.interrupted) return end;
  remove_empty_logs(folder_.log_folder());
  for (const Point& point : points) {
    if (!point.stream.empty()) store_.remove_stream(point.stream);
  }
  return end;
}

namespace {

/// Returns name and last line of the newest log: "slurm-12_3.log: last line". Empty if no task printed anything.
std::string last_log_line(const fs::path& log) {
  fs::file_time_type latest{};
  fs::path file;
  std::error_code gone;
  for (const fs::directory_entry& entry : fs::directory_iterator(log, gone)) {
    const bool is_log = entry.path().filename().string().starts_with("slurm-") && entry.file_size(gone) != 0;
    if (!is_log || entry.last_write_time(gone) < latest) continue;
    latest = entry.last_write_time(gone);
    file = entry.path();
  }
  if (file.empty()) return {};
  std::string last;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) last = line;
  return fmt::format("{}: {}", file.filename().string(), sim::printable(last, 500));
}

}  // namespace

void print_submitted(const SlurmLauncher::Submitted& submitted, std::span<const Point> points, const fs::path& out) {
  std::uint64_t pieces = 0;
  for (const Point& point : points) pieces += point.piece_count();
  fmt::print("{} points{}: {} handed in, {} in the queue already, {} with a result\n", points.size(),
             pieces != points.size() ? fmt::format(", {} slices", pieces) : "", submitted.points, submitted.queued,
             pieces - submitted.points - submitted.queued);
  if (!submitted.jobs.empty()) {
    fmt::print("tasks:  {} of job{} {}\n", submitted.tasks, submitted.jobs.size() == 1 ? "" : "s",
               fmt::join(submitted.jobs, ", "));
  }
  fmt::print("        raywatt sweep status {0}; raywatt sweep cancel {0}\n", command_text({out.string()}));
  fmt::print("        the same command again, when they have ended, makes the table or hands in what is missing\n");
}

void print_missing(const SweepFolder& folder, std::uint64_t missing) {
  const std::string words = last_log_line(folder.log_folder());
  fmt::print(
      "{} points have no result: their tasks were stopped or never began. The same command again hands them in\n",
      missing);
  fmt::print("{}", words.empty() ? "" : fmt::format("  last line in {}/{}\n", folder.log_folder().string(), words));
}

std::optional<sim::Json> slurm_status(const SweepFolder& folder) {
  if (!was_submitted(folder)) return std::nullopt;
  try {
    const SlurmQueue queue = read_queue(folder);
    return sim::Json{
        {"running", queue.running}, {"waiting", queue.waiting}, {"jobs", queue.jobs}, {"reasons", queue.reasons}};
  } catch (const sim::InputError& error) {
    return sim::Json{{"error", error.what()}};
  } catch (const sim::IoError& error) {
    return sim::Json{{"error", error.what()}};
  }
}

void print_slurm_status(const sim::Json& status) {
  if (status.contains("error")) {
    fmt::print("Slurm's queue is unknown: {}\n", status["error"].get<std::string>());
    return;
  }
  const auto joined = [&](const char* key) {
    return fmt::format("{}", fmt::join(status[key].get<std::vector<std::string>>(), ", "));
  };
  if (status["jobs"].empty()) {
    fmt::print("in Slurm's queue: nothing\n");
    return;
  }
  const std::string reasons = joined("reasons");
  fmt::print("in Slurm's queue: {} tasks running, {} waiting{}, of jobs {}\n", status["running"].get<std::uint64_t>(),
             status["waiting"].get<std::uint64_t>(), reasons.empty() ? "" : fmt::format(" ({})", reasons),
             joined("jobs"));
}

bool cancel_on_slurm(const SweepFolder& folder) {
  if (!was_submitted(folder)) return false;
  const SlurmQueue queue = cancel_queue(folder);
  if (queue.jobs.empty()) return false;
  fmt::print("cancelled job{} {}: {} tasks were running, {} waiting\n", queue.jobs.size() == 1 ? "" : "s",
             fmt::join(queue.jobs, ", "), queue.running, queue.waiting);
  return true;
}

}  // namespace tools::sweep
