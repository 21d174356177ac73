#include "tools/studies/sweep/spec/set_metric.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"
#include "traces/scene/did_you_mean.h"

namespace tools::sweep {
namespace {

constexpr std::array<std::string_view, 5> kSetFunctions = {"", "worst", "mean", "geomean", "on"};
constexpr const char* kMetricForms = "allowed: PATH, worst(PATH), mean(PATH), geomean(PATH), on(WORKLOAD, PATH)";

[[noreturn]] void refuse_metric(std::string_view text, std::string_view problem) {
  throw sim::InputError(fmt::format("'{}': {}; {}", sim::printable(text), problem, kMetricForms));
}

std::string_view trim_metric(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::string_view unquote_workload(std::string_view text) {
  const bool is_quoted =
      text.size() >= 2 && (text.front() == '\'' || text.front() == '"') && text.back() == text.front();
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// Returns a path that a report can contain. Throws InputError for any other text.
std::string parse_metric_path(std::string_view path, std::string_view text) {
  constexpr std::string_view kNotOfPaths = "(),'\"<>=! ";
  if (path.empty()) refuse_metric(text, "a report path is missing");
  if (path.find_first_of(kNotOfPaths) != std::string_view::npos) {
    refuse_metric(text, fmt::format("'{}' is no report path", sim::printable(path)));
  }
  return std::string(path);
}

// Path prefixes of metrics with a known better direction, larger or smaller. The longest matching prefix counts.
struct MetricDirection {
  std::string_view prefix;
  bool is_larger_better;
};
constexpr std::array kMetricDirections = {
    MetricDirection{"totals.perf", true},
    MetricDirection{"totals.perf.nj_per_ray", false},
    MetricDirection{"totals.fps_margin", true},
    MetricDirection{"totals.psnr_db", true},
    MetricDirection{"totals.worst_psnr_db", true},
    MetricDirection{"totals.temporal_psnr_db", true},
    MetricDirection{"totals.utilisation", true},
    MetricDirection{"totals.relative", true},
    MetricDirection{"totals.relative.traversal_steps", false},
    MetricDirection{"totals.relative.dram_bytes", false},
    MetricDirection{"totals.relative.tni_power", false},
    MetricDirection{"totals.relative.rays", false},
    MetricDirection{"totals.cycles", false},
    MetricDirection{"totals.time_ms", false},
    MetricDirection{"totals.energy_mj", false},
    MetricDirection{"totals.energy_by_block_mj", false},
    MetricDirection{"totals.energy_by_kind_mj", false},
    MetricDirection{"totals.energy_by_event_mj", false},
    MetricDirection{"totals.power_w", false},
    MetricDirection{"totals.power_at_fps_w", false},
    MetricDirection{"totals.dram_bytes", false},
    MetricDirection{"totals.dram_bytes_by_client", false},
    MetricDirection{"totals.area_mm2", false},
    MetricDirection{"totals.area_band_mm2", false},
    MetricDirection{"totals.area_by_block_mm2", false},
    MetricDirection{"totals.area_by_part_mm2", false},
};

/// True if a report path equals `group` or begins with `group` and a dot.
bool is_in_metric_group(std::string_view path, std::string_view group) {
  return path.starts_with(group) && (path.size() == group.size() || path[group.size()] == '.');
}

/// Number of degrees of freedom from which it counts as infinite.
constexpr double kEndlessDegrees = 1e6;

/// A value with its standard error and the error's degrees of freedom.
struct MetricEstimate {
  double value = 0, error = 0, degrees = kEndlessDegrees;
};

MetricEstimate metric_estimate(const MeasuredMetric& seen) {
  const bool has_degrees = seen.draws && seen.draws->count > 1;
  return {seen.draws ? seen.draws->mean : seen.value, seen.standard_error(),
          has_degrees ? static_cast<double>(seen.draws->count) - 1 : kEndlessDegrees};
}

/// Returns a metric's value with the noise of the estimate. `is_measured`: by replicates, so that Student's t applies.
MeasuredMetric figure_of_estimate(const MetricEstimate& estimate, bool is_measured) {
  MeasuredMetric out;
  out.value = estimate.value;
  if (is_measured) {
    const double count = std::floor(std::clamp(estimate.degrees, 1.0, kEndlessDegrees)) + 1;
    out.draws = Draws{static_cast<std::size_t>(count), estimate.value, estimate.error * std::sqrt(count)};
  } else if (estimate.value != 0) {
    MeasuredMetric unit;
    unit.value = estimate.value;
    unit.assumed = 1;
    out.assumed = estimate.error / unit.standard_error();
  }
  return out;
}

/// Returns `weight` times the sum of independent estimates, with degrees of freedom after Welch and Satterthwaite.
MetricEstimate weighted_sum(std::span<const MetricEstimate> estimates, double weight) {
  MetricEstimate sum;
  double variance = 0, squares = 0;
  for (const MetricEstimate& e : estimates) {
    sum.value += weight * e.value;
    const double part = weight * weight * e.error * e.error;
    variance += part;
    squares += part * part / e.degrees;
  }
  sum.error = std::sqrt(variance);
  if (squares > 0) sum.degrees = std::min(kEndlessDegrees, variance * variance / squares);
  return sum;
}

std::optional<MetricEstimate> geomean_estimate(std::vector<MetricEstimate> estimates) {
  if (std::ranges::any_of(estimates, [](const MetricEstimate& e) { return !(e.value >= 0); })) return std::nullopt;
  if (std::ranges::find(estimates, 0, &MetricEstimate::value) != estimates.end()) return MetricEstimate{};
  for (MetricEstimate& e : estimates) {
    e = {std::log(e.value), e.error / e.value, e.degrees};
  }
  MetricEstimate mean = weighted_sum(estimates, 1 / static_cast<double>(estimates.size()));
  mean.value = std::exp(mean.value);
  mean.error *= mean.value;
  return mean;
}

MetricEstimate worst_estimate(std::span<const MeasuredMetric> figures, bool larger_is_better) {
  constexpr double kSeparated = 0.05;  // significance level of "this workload is better than the worst" (one-sided)
  const auto value_of = [](const MeasuredMetric& seen) { return metric_estimate(seen).value; };
  const MeasuredMetric& worst = larger_is_better ? *std::ranges::min_element(figures, {}, value_of)
                                                 : *std::ranges::max_element(figures, {}, value_of);
  MetricEstimate out = metric_estimate(worst);
  double ties = 0;
  for (const MeasuredMetric& seen : figures) {
    MeanDifference distance = difference_of(worst, seen);
    if (!larger_is_better) distance.value = -distance.value;
    if (&seen != &worst && distance.one_sided_p_value() <= kSeparated) continue;
    ++ties;
    const MetricEstimate tie = metric_estimate(seen);
    if (tie.error <= out.error) continue;
    out.error = tie.error;
    out.degrees = tie.degrees;
  }
  // The expected minimum of k equal normal values lies below their mean; a test in set_metric_test.cc shows that this
  // factor keeps one-sided errors at 5 %.
  out.error *= std::sqrt(1 + std::log(ties));
  return out;
}

}  // namespace

std::string SetMetric::text() const {
  if (kind == SetMetric::Kind::kEach) return path;
  const std::string_view function = kSetFunctions.at(static_cast<std::size_t>(kind));
  return kind == SetMetric::Kind::kOn ? fmt::format("{}({}, {})", function, workload, path)
                                      : fmt::format("{}({})", function, path);
}

SetMetric parse_set_metric(std::string_view text) {
  const std::string_view all = trim_metric(text);
  const std::size_t open = all.find('(');
  if (open == std::string_view::npos) return {SetMetric::Kind::kEach, parse_metric_path(all, text), {}};
  const std::string_view name = trim_metric(all.substr(0, open));
  const auto* const function = std::find(kSetFunctions.begin() + 1, kSetFunctions.end(), name);
  if (function == kSetFunctions.end()) {
    const std::vector<std::string> names(kSetFunctions.begin() + 1, kSetFunctions.end());
    refuse_metric(text, fmt::format("'{}' is no function{}", sim::printable(name),
                                    traces::did_you_mean(std::string(name), names)));
  }
  if (all.back() != ')') refuse_metric(text, "the ) at the end is missing");
  const std::string_view inside = all.substr(open + 1, all.size() - open - 2);
  const SetMetric::Kind kind = static_cast<SetMetric::Kind>(function - kSetFunctions.begin());
  if (kind != SetMetric::Kind::kOn) return {kind, parse_metric_path(trim_metric(inside), text), {}};
  const std::size_t comma = inside.rfind(',');  // names of workloads may contain commas, paths do not
  if (comma == std::string_view::npos)
    refuse_metric(text, "a workload and a path, with a comma between them, are missing");
  const std::string_view workload = unquote_workload(trim_metric(inside.substr(0, comma)));
  if (workload.empty()) refuse_metric(text, "the name of a workload is missing");
  return {kind, parse_metric_path(trim_metric(inside.substr(comma + 1)), text), std::string(workload)};
}

void check_workload(const SetMetric& metric, std::span<const std::string> workloads) {
  if (metric.kind != SetMetric::Kind::kOn || std::ranges::find(workloads, metric.workload) != workloads.end()) return;
  throw sim::InputError(fmt::format(
      "'{}': '{}' is no workload; allowed: {}", sim::printable(metric.text()), sim::printable(metric.workload),
      workloads.empty() ? sim::printable(metric.path) + ", as there is no list of workloads"
                        : list_workloads(workloads)));
}

void check_ranks_machines(const SetMetric& metric, std::string_view path, std::span<const std::string> workloads) {
  if (metric.kind != SetMetric::Kind::kEach || workloads.size() < 2 || is_metric_of_machine(path)) return;
  throw sim::InputError(
      fmt::format("'{0}' has a value for each of {1} workloads; allowed: worst({0}), mean({0}), geomean({0}), on(NAME, "
                  "{0}) with NAME one of {2}",
                  sim::printable(metric.path), workloads.size(), list_workloads(workloads)));
}

std::string list_workloads(std::span<const std::string> workloads) {
  constexpr std::size_t kLongest = 1000;
  return sim::printable(fmt::format("{}", fmt::join(workloads, ", ")), kLongest);
}

std::optional<bool> is_larger_better(std::string_view path) {
  const MetricDirection* found = nullptr;
  for (const MetricDirection& direction : kMetricDirections) {
    const bool is_longer = found == nullptr || direction.prefix.size() > found->prefix.size();
    if (is_in_metric_group(path, direction.prefix) && is_longer) found = &direction;
  }
  return found == nullptr ? std::nullopt : std::optional(found->is_larger_better);
}

bool is_metric_of_machine(std::string_view path) {
  return std::ranges::any_of(
      std::array{"totals.area_mm2", "totals.area_band_mm2", "totals.area_by_block_mm2", "totals.area_by_part_mm2"},
      [&](const char* group) { return is_in_metric_group(path, group); });
}

bool is_larger_better_in(const SetMetric& metric, std::string_view path, bool larger_in_goal) {
  return metric.kind == SetMetric::Kind::kEach ? larger_in_goal : is_larger_better(path).value_or(larger_in_goal);
}

std::optional<double> fold_workloads(SetMetric::Kind kind, std::span<const double> values, bool larger_is_better) {
  if (values.empty() || (kind == SetMetric::Kind::kOn && values.size() != 1)) return std::nullopt;
  if (values.size() == 1) return values.front();
  if (kind == SetMetric::Kind::kEach || kind == SetMetric::Kind::kWorst)
    return larger_is_better ? std::ranges::min(values) : std::ranges::max(values);
  const bool is_geomean = kind == SetMetric::Kind::kGeomean;
  const double weight = 1 / static_cast<double>(values.size());
  double sum = 0;
  for (const double value : values) {
    if (is_geomean && !(value >= 0)) return std::nullopt;
    sum += weight * (is_geomean ? std::log(value) : value);
  }
  return is_geomean ? std::exp(sum) : sum;
}

std::optional<MeasuredMetric> evaluate_set_metric(const SetMetric& metric, std::span<const WorkloadValue> values,
                                                  bool larger_is_better) {
  if (metric.kind == SetMetric::Kind::kOn) {
    const auto found = std::ranges::find(values, metric.workload, &WorkloadValue::workload);
    return found == values.end() ? std::nullopt : found->seen;
  }
  std::vector<MeasuredMetric> figures;
  for (const WorkloadValue& value : values) {
    if (!value.seen) return std::nullopt;
    figures.push_back(*value.seen);
  }
  if (figures.empty()) return std::nullopt;
  if (figures.size() == 1) return figures.front();
  const bool is_measured = std::ranges::all_of(figures, [](const MeasuredMetric& f) { return f.draws.has_value(); });
  std::vector<MetricEstimate> estimates;
  for (const MeasuredMetric& figure : figures) estimates.push_back(metric_estimate(figure));
  if (metric.kind == SetMetric::Kind::kMean) {
    return figure_of_estimate(weighted_sum(estimates, 1 / static_cast<double>(estimates.size())), is_measured);
  }
  if (metric.kind == SetMetric::Kind::kGeomean) {
    const std::optional<MetricEstimate> mean = geomean_estimate(std::move(estimates));
    return mean ? std::optional(figure_of_estimate(*mean, is_measured)) : std::nullopt;
  }
  return figure_of_estimate(worst_estimate(figures, larger_is_better), is_measured);
}

}  // namespace tools::sweep
