#include "tools/studies/optimise/task.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "sim/config/config_tree.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {
namespace {

std::string without_blanks(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

/// Sets the metric of a goal from "PATH", "worst(PATH)", "mean(PATH)", "geomean(PATH)" or "on(WORKLOAD, PATH)".
void set_metric(Goal& goal, const std::string& text) {
  if (without_blanks(text).empty()) return;
  const sweep::SetMetric parsed = sweep::parse_set_metric(text);
  goal.metric = parsed.path;
  goal.fold = parsed.kind;
  goal.workload = parsed.workload;
}

/// Parses a constraint "PATH < NUMBER", also with <=, > or >=. Throws InputError for other text.
Goal parse_constraint_goal(const std::string& text) {
  const std::size_t sign = text.find_first_of("<>");
  if (sign != std::string::npos) {
    const bool or_equal = text.substr(sign + 1).starts_with('=');
    Goal goal;
    goal.kind = text[sign] == '<' ? (or_equal ? Goal::Kind::kAtMost : Goal::Kind::kBelow)
                                  : (or_equal ? Goal::Kind::kAtLeast : Goal::Kind::kAbove);
    set_metric(goal, text.substr(0, sign));
    const std::string number = without_blanks(text.substr(sign + (or_equal ? 2 : 1)));
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), goal.limit);
    const bool is_number = error == std::errc() && std::isfinite(goal.limit) && !goal.metric.empty();
    const std::string_view unit(end, number.data() + number.size());
    if (is_number && unit.empty()) return goal;
    if (is_number) {
      const std::string suffix = without_blanks(std::string(unit));
      // Without the unit the number is right only if the metric's name has this unit: power_w is in W, not mW.
      std::string name_end = "_" + suffix;
      std::ranges::transform(name_end, name_end.begin(),
                             [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      const bool has_unit = goal.metric.find(name_end) != std::string::npos;
      throw sim::InputError(
          fmt::format("constraint '{}': '{}' is not part of a number; a metric has the unit of its name; allowed: {}",
                      sim::printable(text), sim::printable(suffix),
                      has_unit ? fmt::format("'{}'", sim::printable(text.substr(0, text.size() - unit.size())))
                               : "a number in that unit"));
    }
  }
  throw sim::InputError(
      fmt::format("'{}' is not a constraint; allowed: PATH < NUMBER, or with <=, >, >=, e.g. "
                  "power_w.nominal < 1",
                  sim::printable(text)));
}

}  // namespace

bool Goal::is_larger_better() const {
  // Directions are known by full paths.
  const bool is_full = is_totals_path(metric) || !sweep::is_larger_better("totals." + metric);
  return sweep::is_larger_better_in(set_metric(), is_full ? metric : "totals." + metric, !is_less_better());
}

std::optional<double> Goal::combine(std::span<const double> values) const {
  return sweep::fold_workloads(fold, values, is_larger_better());
}

bool Goal::has_limit_per_workload() const {
  return !is_objective() && (fold == sweep::SetMetric::Kind::kOn || applies_to_each_workload());
}

bool Goal::applies_to_each_workload() const {
  using Workloads = sweep::SetMetric::Kind;
  return fold == Workloads::kEach || (fold == Workloads::kWorst && is_larger_better() != is_upper_limit());
}

bool Goal::is_met(double value) const {
  switch (kind) {
    case Kind::kBelow:
      return value < limit;
    case Kind::kAtMost:
      return value <= limit;
    case Kind::kAbove:
      return value > limit;
    case Kind::kAtLeast:
      return value >= limit;
    default:
      return true;
  }
}

std::string Goal::text() const {
  const std::string_view name = names_of(kind).at(static_cast<std::size_t>(kind));
  return is_objective() ? fmt::format("{} {}", name, metric_text())
                        : fmt::format("{} {} {}", metric_text(), name, limit);
}

std::string Goal::metric_text() const { return sweep::SetMetric{fold, metric_name(metric), workload}.text(); }

std::string Goal::distance_title() const {
  return fmt::format("room to {} {}", names_of(kind).at(static_cast<std::size_t>(kind)), limit);
}

double Goal::distance_to_limit(double value) const {
  const double distance = is_upper_limit() ? limit - value : value - limit;
  return limit == 0 ? distance : distance / std::abs(limit);
}

std::string Goal::distance_text(double value) const {
  if (limit == 0) return fmt::format("{:.3g}", distance_to_limit(value));
  const double percent = 100 * distance_to_limit(value);
  return std::abs(percent) < 1 ? fmt::format("{:.2g} %", percent) : fmt::format("{:.1f} %", percent);
}

namespace {

using sweep::YamlValue;

constexpr std::uint64_t kMostBytes = 1 << 20;
constexpr std::array<std::string_view, 8> kKeys = {"objectives", "constraints", "budget",   "seed",
                                                   "population", "batch",       "fidelity", "confidence"};
constexpr std::size_t kMostConstraints = 16;

void read_objectives(const YamlValue& value, std::vector<Goal>& goals) {
  constexpr std::array<std::string_view, 2> kKinds = {"max", "min"};
  for (const YamlValue& item : value.items()) {
    if (!item.is_mapping()) item.refuse("allowed: max: PATH, or min: PATH");
    for (const YamlValue& entry : item.entries(kKinds)) {
      Goal goal;
      goal.kind = entry.key() == "max" ? Goal::Kind::kMax : Goal::Kind::kMin;
      goal.at = entry.where();
      try {
        set_metric(goal, entry.text());
      } catch (const sim::InputError& error) {
        entry.refuse(error.what());
      }
      goals.push_back(std::move(goal));
    }
  }
  if (goals.empty() || goals.size() > 2) {
    value.refuse(fmt::format("has {} objectives; allowed: one or two", goals.size()));
  }
}

/// Error for an axis that changes the workload: the search would choose the easiest workload.
constexpr std::string_view kWorkloadKey =
    "would make the easiest workload part of the answer; allowed: workloads, because a machine is evaluated on all of "
    "them";

double read_confidence(const YamlValue& value) {
  const std::string& text = value.text();
  double share = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), share);
  if (error != std::errc() || end != text.data() + text.size() || !is_confidence(share)) value.refuse(kConfidenceRange);
  return share;
}

void read_constraints(const YamlValue& value, std::vector<Goal>& goals) {
  for (const YamlValue& item : value.items()) {
    try {
      goals.push_back(parse_constraint_goal(item.text()));
    } catch (const sim::InputError& error) {
      item.refuse(error.what());
    }
    goals.back().at = item.where();
  }
  if (goals.size() > kMostConstraints) value.refuse(fmt::format("has more than {}", kMostConstraints));
}

}  // namespace

std::optional<Fidelity> parse_fidelity(std::string_view text) {
  const auto names = names_of(Fidelity{});
  const auto* const found = std::ranges::find(names, text);
  if (found == names.end()) return std::nullopt;
  return static_cast<Fidelity>(found - names.begin());
}

Task read_task(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  return parse_task(*sim::parse_yaml_mapping(sim::read_file(file, kMostBytes), name), name);
}

Task parse_task(const sim::YamlNode& tree, const std::string& name) {
  const YamlValue root(tree, name);
  Task task;
  task.file = name;
  task.space = sweep::read_spec(root, kSchema, kKeys);
  task.sampling = std::exchange(task.space.tile_sampling, "");
  if (!task.sampling.empty()) task.fidelity = Fidelity::kSampled;
  std::vector<Goal> constraints;
  for (const YamlValue& entry : root.entries()) {
    const std::string& key = entry.key();
    if (key == "objectives") {
      read_objectives(entry, task.goals);
    } else if (key == "constraints") {
      read_constraints(entry, constraints);
    } else if (key == "budget") {
      task.budget = entry.whole_number(kLeastBudget, kMostBudget);
    } else if (key == "seed") {
      task.seed = entry.whole_number(0, ~std::uint64_t{0});
    } else if (key == "population") {
      task.population = static_cast<std::uint32_t>(entry.whole_number(8, 400));
      if (task.population % 4 != 0) entry.refuse("allowed: a multiple of 4, which NSGA-II needs");
    } else if (key == "batch") {
      task.batch = static_cast<std::uint32_t>(entry.whole_number(1, 256));
    } else if (key == "fidelity") {
      const std::optional<Fidelity> fidelity = parse_fidelity(entry.text());
      if (!fidelity) entry.refuse("allowed: auto, full, sampled, tiles");
      task.fidelity = *fidelity;
    } else if (key == "confidence") {
      task.confidence = read_confidence(entry);
    } else if (key == "subset") {
      entry.refuse("is for sweeps; a search finds its own points");
    }
  }
  std::size_t first_axis = 0;
  if (task.space.key_positions.contains("workloads")) {
    for (const sweep::Axis::Value& value : task.space.axes.front().values) task.workloads.push_back(value.label);
    first_axis = 1;
  }
  for (std::size_t a = first_axis; a < task.space.axes.size(); ++a) {
    const sweep::Axis& axis = task.space.axes[a];
    if (sweep::changes_workload(axis)) sim::refuse(axis.at, "axes." + axis.name, kWorkloadKey);
  }
  if (task.goals.empty()) root.refuse("has no objectives; allowed: e.g. objectives: [{max: perf.fps}]");
  task.goals.insert(task.goals.end(), constraints.begin(), constraints.end());
  for (const Goal& goal : task.goals) {
    try {
      sweep::check_workload(goal.set_metric(), task.workloads);
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("{}: {}", goal.at, error.what()));
    }
  }
  // By default frames start warm, as within a sequence. Settings of the file come later and override this.
  task.space.sets.insert(task.space.sets.begin(), "frame.start=warm");
  return task;
}

}  // namespace tools::optimise
