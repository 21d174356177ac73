#include "tools/studies/sweep/results/figure_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"
#include "tools/studies/sweep/results/machine_set.h"
#include "tools/studies/sweep/spec/set_metric.h"

namespace tools::results {
namespace {

double number_at(const Column& column, std::size_t row) {
  const std::optional<sweep::Magnitude> number = magnitude_of(column.values[row]);
  return number ? number->value : 0;
}

/// Returns for each point the noise of a metric of `totals` that is assumed for the point's picture size.
std::vector<double> assumed_noise(const Results& results, const std::vector<std::size_t>& rows,
                                  const std::string& figure) {
  const auto noise_at = [&](std::size_t row) {
    const ReportFile report = load_report(results.folder_of(results.rows()[row]));
    return default_noise(report.number("resolution[0]") * report.number("resolution[1]"), figure);
  };
  // all points have the resolution of the configuration
  if (std::ranges::find(results.axes(), "resolution") == results.axes().end()) {
    return std::vector<double>(results.rows().size(), noise_at(rows.front()));
  }
  std::vector<double> out(results.rows().size());
  const Column sizes = results.column("resolution");
  for (const std::size_t row : rows) {
    if (is_absent(sizes.values[row])) {
      out[row] = noise_at(row);
      continue;
    }
    const Resolution size = parse_resolution(exact_text(sizes.values[row]));
    out[row] = default_noise(double{1} * size.width * size.height, figure);
  }
  return out;
}

/// Returns the report path of the replicate statistics of a metric of `totals`.
std::string statistics_path(const std::string& name) { return "totals.replicates.figures." + name; }

/// Returns the relative half-width of the 95 % interval of a metric estimated from sampled tiles or representative
/// frames; 0 for an exact metric.
double sampling_error(const ReportFile& report, const std::string& figure) {
  const bool has_frames = report.has("totals.representative.frames");
  const std::string path = (has_frames ? "totals.representative." : "totals.sampled.") + figure;
  const double estimate = report.number(path + ".estimate");
  return estimate == 0 ? 0 : (report.number(path + ".high") - report.number(path + ".low")) / 2 / estimate;
}

}  // namespace

MeasuredMetric read_noisy_metric(const ReportFile& report, const std::string& path) {
  const double value = report.number(path);
  const std::string name = is_totals_path(path) ? metric_name(path) : std::string();
  if (!tools::is_noisy(name)) return {.value = value};
  const std::string draws = statistics_path(name);
  if (report.has("totals.replicates.count") && report.has(draws + ".mean")) {
    const Draws drawn{static_cast<std::size_t>(report.number("totals.replicates.count")),
                      report.number(draws + ".mean"), report.number(draws + ".deviation")};
    return {drawn.mean, drawn};
  }
  const double pixels = report.number("resolution[0]") * report.number("resolution[1]");
  // Assumed noise is that of a difference of two values, which is sqrt(2) times that of one value.
  const double sampled =
      std::numbers::sqrt2 * std::max(sampling_error(report, "cycles"), sampling_error(report, "energy_mj"));
  return {value, std::nullopt, std::hypot(default_noise(pixels, name), sampled)};
}

MetricNoise::MetricNoise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows)
    : means_(figure), seen_(results.rows().size()), replicates_(results.rows().size()) {
  if (figure.fold) {
    fold_noise(results, figure, rows);
    return;
  }
  for (std::size_t row = 0; row < seen_.size(); ++row) seen_[row].value = number_at(figure, row);
  const std::string name = is_totals_path(figure.name) ? metric_name(figure.name) : std::string();
  noisy_ = tools::is_noisy(name) && !rows.empty();
  if (!noisy_) return;
  const std::string at = statistics_path(name);
  const auto range = [&](const auto& of) {
    least_ = most_ = of(seen_[rows.front()]);
    for (const std::size_t row : rows) {
      least_ = std::min(least_, of(seen_[row]));
      most_ = std::max(most_, of(seen_[row]));
    }
  };
  if (results.has_metric(at + ".mean") && results.has_metric("totals.replicates.count")) {
    const Column mean = results.column(at + ".mean"), deviation = results.column(at + ".deviation"),
                 count = results.column("totals.replicates.count");
    measured_ = std::ranges::none_of(rows, [&](std::size_t row) { return is_absent(mean.values[row]); });
    for (const std::size_t row : measured_ ? rows : std::vector<std::size_t>()) {
      seen_[row].draws =
          Draws{static_cast<std::size_t>(number_at(count, row)), number_at(mean, row), number_at(deviation, row)};
      seen_[row].value = seen_[row].draws->mean;
      replicates_[row] = seen_[row].draws->count;
      means_.values[row] = mean.values[row];
    }
    if (measured_) {
      range([](const MeasuredMetric& seen) { return static_cast<double>(seen.draws->count); });
      return;
    }
  }
  const std::vector<double> assumed = assumed_noise(results, rows, name);
  for (const std::size_t row : rows) seen_[row].assumed = assumed[row];
  range([](const MeasuredMetric& seen) { return seen.assumed; });
}

void MetricNoise::fold_noise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows) {
  const MachineSet& machines = results.machines();
  const Fold& fold = *figure.fold;
  std::vector<std::size_t> points = machines.points_of(rows);
  std::erase_if(points, [&](std::size_t row) { return !magnitude_of(fold.points.values[row]); });
  const MetricNoise of_points(results, fold.points, points);
  noisy_ = of_points.noisy_;
  measured_ = of_points.measured_;
  least_ = of_points.least_;
  most_ = of_points.most_;
  means_ = fold_other_values(machines, fold, of_points.means_);
  for (const std::size_t row : rows) {
    std::vector<sweep::WorkloadValue> values;
    const auto& of_machine = machines.rows[machines.machine_of[row]];
    for (std::size_t w = 0; w < of_machine.size(); ++w) {
      sweep::WorkloadValue& value = values.emplace_back();
      if (!machines.workloads.empty()) value.workload = machines.workloads[w];
      if (of_machine[w] && magnitude_of(fold.points.values[*of_machine[w]])) {
        value.seen = of_points.seen_[*of_machine[w]];
        replicates_[row] = of_points.replicates_[*of_machine[w]];
      }
    }
    seen_[row] = sweep::evaluate_set_metric(fold.metric, values, fold.larger_is_better).value_or(MeasuredMetric{});
  }
}

double MetricNoise::p_value_better(std::size_t b, std::size_t a, bool more_is_better) const {
  MeanDifference d = difference_of(seen_[a], seen_[b]);
  if (!more_is_better) d.value = -d.value;
  return d.one_sided_p_value();
}

std::string interval_text(const MetricNoise& noise, std::size_t row) {
  const double value = number_at(noise.means(), row);
  return fmt::format("± {:.2g} %", value == 0 ? 0 : 100 * noise.half_width(row) / std::abs(value));
}

std::string MetricNoise::describe() const {
  if (is_measured()) {
    const std::string to = least_ == most_ ? "" : fmt::format(" to {:.0f}", most_);
    return fmt::format("noise measured by {:.0f}{} replicates per point", least_, to);
  }
  const std::string to = least_ == most_ ? "" : fmt::format(" to {:.2g}", 100 * most_);
  return fmt::format("noise of {:.2g}{} % is assumed; set `replicates:` in the sweep file to measure it", 100 * least_,
                     to);
}

std::string extrapolated_note(const Results& results, const std::vector<std::size_t>& rows) {
  constexpr const char* kFigure = "totals.extrapolated";
  constexpr std::size_t kNamed = 12;
  if (!results.has_metric(kFigure)) return {};
  const Column column = results.column(kFigure);
  std::vector<std::int64_t> points;
  for (const std::size_t row : rows) {
    const auto count = magnitude_of(column.values[row]);
    if (count && count->value > 0) points.push_back(results.rows()[row].n);
  }
  if (points.empty()) return {};
  std::ranges::sort(points);
  const std::size_t more = points.size() - std::min(points.size(), kNamed);
  points.resize(points.size() - more);
  return fmt::format("\nfigures beyond what the tables cover, as warnings[] of the reports say: point{} {}{}\n",
                     points.size() == 1 ? "" : "s", fmt::join(points, ", "),
                     more == 0 ? "" : fmt::format(" and {} more", more));
}

std::vector<std::string> extrapolation_lines(const sim::Json& report) {
  const sim::JsonPointer count("/totals/extrapolated"), warnings("/warnings");
  std::vector<std::string> lines;
  if (!report.contains(count) || report[count] == 0 || !report.contains(warnings)) return lines;
  // Only warnings about extrapolation begin with the name of a table or of a table's key.
  constexpr std::array<std::string_view, 6> kTables = {"energy.events", "area.arrays",       "latency.arrays",
                                                       "power.dvfs",    "power.max_voltage", "process"};
  for (const sim::Json& line : report[warnings]) {
    if (!line.is_string()) continue;
    const auto is_of = [text = line.get<std::string>()](std::string_view table) { return text.starts_with(table); };
    if (std::ranges::any_of(kTables, is_of)) lines.push_back(line.get<std::string>());
  }
  return lines;
}

std::string energy_draws_note(const std::vector<const MetricNoise*>& figures) {
  const auto some = [&](auto is) { return std::ranges::any_of(figures, [&](const MetricNoise* f) { return is(*f); }); };
  std::string out;
  if (some([](const MetricNoise& f) { return f.is_noisy(); })) {
    out += "the draws vary the energy tables only; they do not include noise\n";
  }
  if (some([](const MetricNoise& f) { return f.is_noisy() && f.is_measured(); })) {
    out += "a draw takes the counts of replicate 0, and the metric is the mean of all replicates\n";
  }
  if (some([](const MetricNoise& f) { return report_path(f.means()).ends_with("_per_mm2"); })) {
    out += "area is nominal in all draws\n";
  }
  return out;
}

}  // namespace tools::results
