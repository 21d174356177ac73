#include "tools/studies/baseline/measure.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "tools/analysis/report_paths.h"
#include "tools/host/exit_code.h"
#include "tools/run/run.h"

namespace tools {
namespace {

using sim::Json;

/// Returns the report of a run, or {"error": text, "is_input": true if the user can fix it}. std::bad_alloc is thrown.
Json report_or_error(const JobOptions& options) {
  try {
    return plain_report(load_inputs(options), options);
  } catch (const sim::Deadlock& error) {
    return {{"error", fmt::format("{}\n{}", error.what(), error.state)}, {"is_input", false}};
  } catch (const sim::InputError& error) {
    return {{"error", error.what()}, {"is_input", true}};
  } catch (const std::bad_alloc&) {  // a temporary shortage of the host, not a failure of the run
    throw;
  } catch (const std::exception& error) {
    return {{"error", error.what()}, {"is_input", false}};
  }
}

/// Returns the replicate statistics of the noisy figures of `totals`, by path.
StoredDraws draws_of_replicates(const Json& replicates) {
  StoredDraws out;
  const auto count = replicates["count"].get<std::size_t>();
  constexpr std::string_view kMean = "/mean";
  const Json& figures = replicates["figures"];
  const Json flat = figures.flatten();
  for (const auto& [pointer, mean] : flat.items()) {
    if (!pointer.ends_with(kMean)) continue;
    const std::string at = pointer.substr(0, pointer.size() - kMean.size());
    std::string path = "totals" + at;
    std::ranges::replace(path, '/', '.');
    out[path] = {count, mean.get<double>(), figures.at(sim::JsonPointer(at + "/deviation")).get<double>()};
  }
  return out;
}

Measured measured_from(const SuiteRun& run, const std::string& text, int status, double seconds) {
  Measured out;
  out.seconds = seconds;
  if (WIFSIGNALED(status)) {
    out.error = fmt::format("ended by signal {}", WTERMSIG(status));
    return out;
  }
  Json report;
  try {
    report = sim::parse_json(text);
  } catch (const sim::JsonError&) {  // the process ended before the report was complete
  }
  if (WEXITSTATUS(status) == kIoFailed) throw std::bad_alloc();
  if (!report.is_object()) {
    out.error = fmt::format("ended with {} before its report", WEXITSTATUS(status));
  } else if (report.contains("error")) {
    out.error = report["error"].get<std::string>();
    if (report["is_input"].get<bool>()) throw sim::InputError(fmt::format("runs.{}: {}", run.name, out.error));
  } else {
    out.facts = {report["program"].get<std::string>(), report["provenance"]["scene_sha256"].get<std::string>(),
                 report["provenance"]["bvh_hash"].get<std::string>(), flat_config(report["config"])};
    out.facts.config.erase("scene.name");
    for (ReportNumber& number : report_numbers(report)) {
      if (number.path.find(".replicates.") == std::string::npos) out.all.emplace(std::move(number.path), number.value);
    }
    if (run.options.replicates > 1) out.draws = draws_of_replicates(report["totals"]["replicates"]);
  }
  return out;
}

[[noreturn]] void throw_errno(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

/// A run in its own process, which writes its report to a pipe.
class Worker {
 public:
  Worker(std::size_t number, const SuiteRun& run) : index_(number), run_(&run), begin_(sim::HostClock::now()) {
    int ends[2];
    if (::pipe(ends) != 0) throw_errno("pipe");
    process_ = ::fork();
    if (process_ < 0) throw_errno("fork");
    if (process_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);  // the parent prints the message
      ::close(ends[0]);
      std::_Exit(run_and_send(ends[1]));
    }
    ::close(ends[1]);
    end_ = ends[0];
  }

  std::size_t run_index() const { return index_; }
  int pipe_end() const { return end_; }
  /// Reads available data. Returns false at the end.
  bool receive_data() {
    char part[1 << 16];
    const ssize_t n = ::read(end_, part, sizeof part);
    if (n > 0) text_.append(part, static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) throw_errno("pipe");
    return n != 0;
  }
  Measured wait_for_result() {
    ::close(end_);
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    return measured_from(*run_, text_, status, sim::seconds_since(begin_));
  }

 private:
  /// Simulates and returns the exit code: 0, kIoFailed if memory ran out, else 1.
  int run_and_send(int file) const {
    try {
      return send_report(file, sim::json_line(report_or_error(run_->options)));
    } catch (const std::bad_alloc&) {
      return kIoFailed;
    }
  }
  static int send_report(int file, std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(file, text.data(), text.size());
      if (written < 0) return 1;
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
  }

  std::size_t index_;
  const SuiteRun* run_;
  sim::HostClock::time_point begin_;
  pid_t process_ = -1;
  int end_ = -1;
  std::string text_;
};

}  // namespace

void simulate_suite(const Suite& suite, std::uint32_t jobs,
                    const std::function<void(const SuiteRun&, Measured)>& take) {
  std::vector<std::optional<Measured>> done(suite.runs.size());
  std::vector<Worker> workers;
  std::size_t next = 0, taken = 0;
  while (taken < suite.runs.size()) {
    while (workers.size() < jobs && next < suite.runs.size()) {
      workers.emplace_back(next, suite.runs[next]);
      next += 1;
    }
    std::vector<pollfd> ends;
    for (const Worker& worker : workers) ends.push_back({worker.pipe_end(), POLLIN, 0});
    if (::poll(ends.data(), ends.size(), -1) < 0 && errno != EINTR) throw_errno("poll");
    for (std::size_t i = workers.size(); i-- > 0;) {
      if (ends[i].revents == 0 || workers[i].receive_data()) continue;
      done[workers[i].run_index()] = workers[i].wait_for_result();
      workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (; taken < done.size() && done[taken]; ++taken) take(suite.runs[taken], *std::move(done[taken]));
  }
}

}  // namespace tools
