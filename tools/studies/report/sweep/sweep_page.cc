#include "tools/studies/report/sweep/sweep_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/sweep/sweep_parts.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/spec/spec.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;

/// The file of a search says what it is about; that of a sweep says other things, and is none.
std::optional<optimise::Task> task_in(const fs::path& folder) {
  try {
    return optimise::read_task(folder / "sweep.yaml");
  } catch (const sim::InputError&) {
    return std::nullopt;
  }
}

std::string question_in(const fs::path& folder) {
  try {
    return sweep::read_spec(folder / "sweep.yaml").question;
  } catch (const sim::InputError&) {
    return {};  // results are good all the same
  }
}

View view_of(const fs::path& folder) {
  const results::Results results(folder);
  Sweep sweep{
      results, sweep::SweepFolder::open(folder).read_points(), {}, {}, task_in(folder), {}, results.varying_axes(), {},
      {}};
  const bool fits = sweep.points.size() == results.rows().size() &&
                    std::ranges::equal(sweep.points, results.rows(), {}, &sweep::Point::id, &results::Row::id);
  if (!fits) throw sim::InputError(folder.string() + ": has other points than its index; run 'raywatt sweep collect'");
  sweep.name = sim::printable(fs::absolute(folder / "x").parent_path().filename().string());
  sweep.question = sweep.task ? sweep.task->space.question : question_in(folder);
  if (sweep.task) sweep.goal_paths = goal_paths_of(results, *sweep.task);
  sweep.metrics = metrics_of(results, sweep.goal_paths);
  for (std::size_t g = 0; g < sweep.goal_paths.size(); ++g) {
    const optimise::Goal& goal = sweep.task->goals[g];
    const auto metric = std::ranges::find(sweep.metrics, sweep.goal_paths[g], &Metric::path);
    if (goal.is_objective() && metric != sweep.metrics.end()) metric->more = goal.kind == optimise::Goal::Kind::kMax;
  }
  for (const Metric& metric : sweep.metrics) sweep.values.push_back(results::column_of_means(results, metric.path));
  View view(sweep.name);
  add_sweep_verdict(sweep, view);
  add_points(sweep, view);
  add_sensitivities(sweep, view);
  return view;
}

}  // namespace

bool is_sweep(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "sweep.json", ignored);
}

View sweep_view(const fs::path& folder) {
  results::collect_if_writable(folder, "the page has");
  return view_of(folder);
}

}  // namespace tools::pages
