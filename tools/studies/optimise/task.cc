#include "tools/studies/optimise/task.h"

#include <algorithm>
#include <array>
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

/// Parses "PATH < NUMBER", or with <=, >, >=; throws InputError for other text.
Goal parse_constraint_goal(const std::string& text) {
  const std::size_t sign = text.find_first_of("<>");
  if (sign != std::string::npos) {
    const bool or_equal = text.substr(sign + 1).starts_with('=');
    Goal goal;
    goal.kind = text[sign] == '<' ? (or_equal ? Goal::Kind::kAtMost : Goal::Kind::kBelow)
                                  : (or_equal ? Goal::Kind::kAtLeast : Goal::Kind::kAbove);
    goal.metric = without_blanks(text.substr(0, sign));
    const std::string number = without_blanks(text.substr(sign + (or_equal ? 2 : 1)));
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), goal.limit);
    const bool is_number = error == std::errc() && std::isfinite(goal.limit) && !goal.metric.empty();
    const std::string_view unit(end, number.data() + number.size());
    if (is_number && unit.empty()) return goal;
    if (is_number) {
      throw sim::InputError(
          fmt::format("constraint '{}': '{}' is not part of a number; a metric has the unit of its name; "
                      "allowed: '{}'",
                      sim::printable(text), sim::printable(without_blanks(std::string(unit))),
                      sim::printable(text.substr(0, text.size() - unit.size()))));
    }
  }
  throw sim::InputError(
      fmt::format("'{}' is not a constraint; allowed: PATH < NUMBER, or with <=, >, >=, e.g. "
                  "power_w.nominal < 1",
                  sim::printable(text)));
}

}  // namespace

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
  return is_objective() ? fmt::format("{} {}", name, metric_name(metric))
                        : fmt::format("{} {} {}", metric_name(metric), name, limit);
}

std::string Goal::distance_title() const {
  return fmt::format("room to {} {}", names_of(kind).at(static_cast<std::size_t>(kind)), limit);
}

double Goal::distance_to_limit(double value) const {
  const double distance = is_upper() ? limit - value : value - limit;
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
constexpr std::string_view kSchema = "raywatt-optimise/1";
constexpr std::array<std::string_view, 7> kKeys = {"objectives", "constraints", "budget",  "seed",
                                                   "population", "batch",       "fidelity"};
constexpr std::size_t kMostConstraints = 16;

void read_objectives(const YamlValue& value, std::vector<Goal>& goals) {
  constexpr std::array<std::string_view, 2> kKinds = {"max", "min"};
  for (const YamlValue& item : value.items()) {
    if (!item.is_mapping()) item.refuse("allowed: max: PATH, or min: PATH");
    for (const YamlValue& entry : item.entries(kKinds)) {
      Goal goal;
      goal.kind = entry.key() == "max" ? Goal::Kind::kMax : Goal::Kind::kMin;
      goal.metric = entry.text();
      goal.at = entry.where();
      goals.push_back(std::move(goal));
    }
  }
  if (goals.empty() || goals.size() > 2) {
    value.refuse(fmt::format("has {} objectives; allowed: one or two", goals.size()));
  }
}

/// Workloads are refused as an axis, because the search would choose the easiest one.
constexpr std::string_view kOneWorkload =
    "would make the easiest workload part of the answer; allowed: one workload, by scene, camera, frames and "
    "resolution";

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

Task read_task(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  const auto tree = sim::parse_yaml_mapping(sim::read_file(file, kMostBytes), name);
  const YamlValue root(*tree, name);
  Task task;
  task.file = name;
  task.space = sweep::read_spec(root, kSchema, kKeys);
  task.looks_sampling = std::exchange(task.space.tile_sampling, "");
  task.sampled = !task.looks_sampling.empty();
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
      if (entry.text() != "full" && entry.text() != "sampled") entry.refuse("allowed: full, sampled");
      task.sampled = entry.text() == "sampled";
    } else if (key == "workloads") {
      entry.refuse(kOneWorkload);
    } else if (key == "subset") {
      entry.refuse("is for sweeps; a search finds its own points");
    }
  }
  const auto of_workloads = std::ranges::find_if(task.space.axes, &sweep::changes_workload);
  if (of_workloads != task.space.axes.end()) sim::refuse(of_workloads->at, "axes." + of_workloads->name, kOneWorkload);
  if (task.goals.empty()) root.refuse("has no objectives; allowed: e.g. objectives: [{max: perf.fps}]");
  task.goals.insert(task.goals.end(), constraints.begin(), constraints.end());
  if (task.looks_sampling.empty()) task.looks_sampling = "auto";
  return task;
}

}  // namespace tools::optimise
