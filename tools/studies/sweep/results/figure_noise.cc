#include "tools/studies/sweep/results/figure_noise.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/analysis/report_file.h"
#include "tools/analysis/report_paths.h"
#include "tools/run/frame/job_options.h"

namespace tools::results {
namespace {

double number_at(const Column& column, std::size_t row) {
  const std::optional<sweep::Magnitude> number = amount_of(column.values[row]);
  return number ? number->value : 0;
}

/// Noise of a figure of totals that is assumed for the picture of each point.
std::vector<double> assumed_noise(const Results& results, const std::vector<std::size_t>& rows,
                                  const std::string& figure) {
  const auto noise_at = [&](std::size_t row) {
    const ReportFile report = load_report(results.folder_of(results.rows()[row]));
    return default_noise(report.number("resolution[0]") * report.number("resolution[1]"), figure);
  };
  if (std::ranges::find(results.axes(), "resolution") == results.axes().end()) {  // the configuration's for all
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

/// Path of the statistics of a figure that is "cycles" among the totals.
std::string statistics_path(const std::string& name) { return "totals.replicates.figures." + name; }

}  // namespace

FigureNoise::FigureNoise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows)
    : means_(figure), seen_(results.rows().size()) {
  for (std::size_t row = 0; row < seen_.size(); ++row) seen_[row].value = number_at(figure, row);
  const std::string name = is_total(figure.name) ? metric_name(figure.name) : std::string();
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
      means_.values[row] = mean.values[row];
    }
    if (measured_) {
      range([](const SeenFigure& seen) { return static_cast<double>(seen.draws->count); });
      return;
    }
  }
  const std::vector<double> assumed = assumed_noise(results, rows, name);
  for (const std::size_t row : rows) seen_[row].assumed = assumed[row];
  range([](const SeenFigure& seen) { return seen.assumed; });
}

double FigureNoise::chance_better(std::size_t b, std::size_t a, bool most) const {
  MeanDifference d = difference_of(seen_[a], seen_[b]);
  if (!most) d.value = -d.value;
  return d.chance_above();
}

std::string give_or_take(const FigureNoise& noise, std::size_t row) {
  const double value = number_at(noise.means(), row);
  return fmt::format("± {:.2g} %", value == 0 ? 0 : 100 * noise.half_width(row) / std::abs(value));
}

std::string FigureNoise::text() const {
  if (is_measured()) {
    const std::string to = least_ == most_ ? "" : fmt::format(" to {:.0f}", most_);
    return fmt::format("noise measured by {:.0f}{} replicates a point", least_, to);
  }
  const std::string to = least_ == most_ ? "" : fmt::format(" to {:.2g}", 100 * most_);
  return fmt::format("a noise of {:.2g}{} %, assumed for this size of picture; 'replicates' in the file measure it",
                     100 * least_, to);
}

Column column_of_means(const Results& results, const std::string& path) {
  Column figure = results.column(path);
  if (!is_total(figure.name)) return figure;
  const std::string mean = statistics_path(metric_name(figure.name)) + ".mean";
  if (!results.has_metric(mean)) return figure;
  const Column means = results.column(mean);
  for (std::size_t row = 0; row < figure.values.size(); ++row) {
    if (!is_absent(means.values[row])) figure.values[row] = means.values[row];
  }
  return figure;
}

}  // namespace tools::results
