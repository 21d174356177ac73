#include "tools/studies/baseline/measure.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "tools/analysis/report_paths.h"
#include "tools/host/child_process.h"
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

/// A run that is being simulated in a child process.
struct Worker {
  std::size_t run = 0;  ///< index in the suite
  sim::HostClock::time_point begin = sim::HostClock::now();
  std::unique_ptr<ChildProcess> child;
};

std::unique_ptr<ChildProcess> start_run(const SuiteRun& run) {
  return std::make_unique<ChildProcess>([&] {
    try {
      return sim::json_line(report_or_error(run.options));
    } catch (const std::bad_alloc&) {
      std::_Exit(kIoFailed);
    }
  });
}

}  // namespace

void simulate_suite(const Suite& suite, std::uint32_t jobs,
                    const std::function<void(const SuiteRun&, Measured)>& take) {
  std::vector<std::optional<Measured>> done(suite.runs.size());
  std::vector<Worker> workers;
  std::size_t next = 0, taken = 0;
  while (taken < suite.runs.size()) {
    for (; workers.size() < jobs && next < suite.runs.size(); ++next) {
      workers.push_back({.run = next, .child = start_run(suite.runs[next])});
    }
    std::vector<pollfd> ends;
    for (const Worker& worker : workers) ends.push_back({worker.child->pipe_end(), POLLIN, 0});
    if (::poll(ends.data(), ends.size(), -1) < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "poll");
    }
    for (std::size_t i = workers.size(); i-- > 0;) {
      const auto& [run, begin, child] = workers[i];
      if (ends[i].revents == 0 || child->receive_data()) continue;
      const int status = child->wait_for_exit();
      done[run] = measured_from(suite.runs[run], child->received_text(), status, sim::seconds_since(begin));
      workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (; taken < done.size() && done[taken]; ++taken) take(suite.runs[taken], *std::move(done[taken]));
  }
}

}  // namespace tools
