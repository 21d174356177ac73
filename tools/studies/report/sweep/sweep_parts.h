#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/optimise/task.h"
#include "tools/studies/report/page/page_model.h"
#include "tools/studies/sweep/results/pareto.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::pages {

/// A figure of the points.
struct Metric {
  std::string path;   ///< in a report
  std::string words;  ///< "frames/J"
  Show show = Show::kNumber;
  std::string unit = {};
  bool more = false;  ///< more is better
};

/// A sweep or a search, as the parts of its page read it.
struct Sweep {
  const results::Results& results;
  std::vector<sweep::Point> points;
  std::string name, question;
  std::optional<optimise::Task> task;   ///< a search's
  std::vector<std::string> goal_paths;  ///< of the task's goals, in full; empty for a figure that no point has
  std::vector<results::Column> axes;    ///< that vary
  std::vector<Metric> metrics;          ///< that points have
  std::vector<results::Column> values;  ///< the metrics', means of replicates where there are some

  std::vector<bool> done() const;
  bool has_constraints() const;
  /// Points that are done and meet the constraints of a search: those that may be best, or on the front.
  std::vector<bool> eligible() const;
  const Metric* metric(const std::string& path) const;
  /// The metric of one of the task's goals; nullptr if no point has it.
  const Metric* metric_of_goal(std::size_t goal) const { return metric(goal_paths[goal]); }
  /// Values of one of `metrics`.
  const results::Column& values_of(const Metric& metric) const;
};

std::vector<std::string> goal_paths_of(const results::Results& results, const optimise::Task& task);
/// Figures of which at least one point has a number: the usual ones, and those that a search is about.
std::vector<Metric> metrics_of(const results::Results& results, const std::vector<std::string>& goal_paths);

/// Notices of extrapolated figures: what they are at the best point, and which other points have some.
void add_extrapolations(const Sweep& sweep, std::optional<std::size_t> best, View& view);
/// How many points meet each constraint of a search, and how far the best one is from its limits.
void add_limits(const Sweep& sweep, std::optional<std::size_t> best, View& view);
void add_sweep_verdict(const Sweep& sweep, View& view);
void add_points(const Sweep& sweep, View& view);
void add_sensitivities(const Sweep& sweep, View& view);

}  // namespace tools::pages
