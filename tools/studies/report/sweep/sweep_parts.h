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
  std::vector<results::Column> axes;    ///< that vary
  std::vector<Metric> metrics;          ///< that points have
  std::vector<results::Column> values;  ///< the metrics', means of replicates where there are some

  std::vector<bool> done() const;
  bool has_constraints() const;
  /// Points that are done and meet the constraints of a search: those that may be best, or on the front.
  std::vector<bool> eligible() const;
  const Metric* metric(const std::string& path) const;
  /// Values of one of `metrics`.
  const results::Column& values_of(const Metric& metric) const;
};

/// Figures of which at least one point has a number: the usual ones, and those that a search is about.
std::vector<Metric> metrics_of(const results::Results& results, const std::optional<optimise::Task>& task);

void add_sweep_verdict(const Sweep& sweep, View& view);
void add_points(const Sweep& sweep, View& view);
void add_sensitivities(const Sweep& sweep, View& view);

}  // namespace tools::pages
