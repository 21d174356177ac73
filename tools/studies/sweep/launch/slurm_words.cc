#include "tools/studies/sweep/launch/slurm_words.h"

#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/launch/slurm_queue.h"

namespace tools {
namespace {

namespace fs = std::filesystem;

/// "slurm-12_3.log: its last line" of the log written last; empty if tasks said nothing.
std::string last_words(const fs::path& log) {
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

void tell_submitted(const sweep::SlurmLauncher::Submitted& submitted, std::span<const sweep::Point> points,
                    const fs::path& out) {
  std::uint64_t pieces = 0;
  for (const sweep::Point& point : points) pieces += point.pieces();
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

void tell_missing(const sweep::SweepFolder& folder, std::uint64_t missing) {
  const std::string words = last_words(folder.log());
  fmt::print(
      "{} points have no result: their tasks were stopped or never began. The same command again hands them in\n",
      missing);
  fmt::print("{}", words.empty() ? "" : fmt::format("  last said in {}/{}\n", folder.log().string(), words));
}

std::optional<sim::Json> slurm_status(const sweep::SweepFolder& folder) {
  if (!sweep::was_submitted(folder)) return std::nullopt;
  try {
    const sweep::SlurmQueue queue = sweep::queue_of(folder);
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

bool cancel_on_slurm(const sweep::SweepFolder& folder) {
  if (!sweep::was_submitted(folder)) return false;
  const sweep::SlurmQueue queue = sweep::cancel_jobs(folder);
  if (queue.jobs.empty()) return false;
  fmt::print("cancelled job{} {}: {} tasks were running, {} waiting\n", queue.jobs.size() == 1 ? "" : "s",
             fmt::join(queue.jobs, ", "), queue.running, queue.waiting);
  return true;
}

}  // namespace tools
