#include "tools/studies/sweep/results/figure_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/simulation/job_options.h"

namespace tools::results {
namespace {

constexpr std::string_view kTotals = "totals.";

double number_at(const Column& column, std::size_t row) {
  const std::optional<sweep::Magnitude> number = amount_of(column.values[row]);
  return number ? number->value : 0;
}

double noise_of(const ReportFile& report) {
  return default_noise(report.number("resolution[0]") * report.number("resolution[1]"));
}

/// Noise assumed for the picture of each point.
std::vector<double> assumed_noise(const Results& results, const std::vector<std::size_t>& rows) {
  const auto noise_at = [&](std::size_t row) { return noise_of(load_report(results.folder_of(results.rows()[row]))); };
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
    out[row] = default_noise(double{1} * size.width * size.height);
  }
  return out;
}

}  // namespace

FigureNoise::FigureNoise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows)
    : means_(figure) {
  const std::string name = figure.name.starts_with(kTotals) ? figure.name.substr(kTotals.size()) : std::string();
  noisy_ = tools::is_noisy(name) && !rows.empty();
  if (!noisy_) return;
  const std::string at = "totals.replicates.figures." + name;
  const auto range = [&](const auto& of) {
    least_ = most_ = of(rows.front());
    for (const std::size_t row : rows) {
      least_ = std::min(least_, of(row));
      most_ = std::max(most_, of(row));
    }
  };
  if (results.has_metric(at + ".mean") && results.has_metric("totals.replicates.count")) {
    const Column mean = results.column(at + ".mean"), deviation = results.column(at + ".deviation"),
                 count = results.column("totals.replicates.count");
    if (std::ranges::none_of(rows, [&](std::size_t row) { return is_absent(mean.values[row]); })) {
      draws_.resize(results.rows().size());
      for (const std::size_t row : rows) {
        draws_[row] = {static_cast<std::size_t>(number_at(count, row)), number_at(mean, row),
                       number_at(deviation, row)};
        means_.values[row] = mean.values[row];
      }
      range([&](std::size_t row) { return static_cast<double>(draws_[row].count); });
      return;
    }
  }
  assumed_ = assumed_noise(results, rows);
  range([&](std::size_t row) { return assumed_[row]; });
}

double FigureNoise::at(std::size_t row) const { return number_at(means_, row); }

double FigureNoise::error(std::size_t row) const {
  if (!noisy_) return 0;
  if (is_measured()) return difference_of(draws_[row], Draws{1, 0, 0}).error;
  return difference_of(AssumedDraw{at(row), assumed_[row]}, AssumedDraw{}).error;
}

double FigureNoise::half_width(std::size_t row) const {
  if (is_measured()) return draws_[row].half_width();
  return student_t(std::numeric_limits<double>::infinity()) * error(row);
}

double FigureNoise::chance_better(std::size_t b, std::size_t a, bool most) const {
  MeanDifference d{at(b) - at(a), 0, 1};
  if (is_measured()) {
    d = difference_of(draws_[a], draws_[b]);
  } else if (noisy_) {
    d = difference_of(AssumedDraw{at(a), assumed_[a]}, AssumedDraw{at(b), assumed_[b]});
  }
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
  return fmt::format("a noise of {:.2g}{} %, assumed for this size of picture; 'replicates' in the sweep measure it",
                     100 * least_, to);
}

}  // namespace tools::results
