#include "tools/studies/sweep/results/notes.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/io/json.h"

namespace tools::results {

std::string extrapolated_note(const Results& results, const std::vector<std::size_t>& rows) {
  constexpr const char* kFigure = "totals.extrapolated";
  constexpr std::size_t kNamed = 12;
  if (!results.has_metric(kFigure)) return {};
  const Column column = results.column(kFigure);
  std::vector<std::int64_t> points;
  for (const std::size_t row : rows) {
    const auto count = amount_of(column.values[row]);
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
  // These warnings begin with the table that is left; other warnings do not.
  constexpr std::array<std::string_view, 4> kTables = {"energy.events", "area.arrays", "latency.arrays", "power.dvfs"};
  for (const sim::Json& line : report[warnings]) {
    if (!line.is_string()) continue;
    const auto is_of = [text = line.get<std::string>()](std::string_view table) { return text.starts_with(table); };
    if (std::ranges::any_of(kTables, is_of)) lines.push_back(line.get<std::string>());
  }
  return lines;
}

std::string draws_note(const std::vector<const FigureNoise*>& figures) {
  const auto some = [&](auto is) { return std::ranges::any_of(figures, [&](const FigureNoise* f) { return is(*f); }); };
  std::string out;
  if (some([](const FigureNoise& f) { return f.is_noisy(); })) {
    out += "the draws are of the energy tables alone: of noise they say nothing\n";
  }
  if (some([](const FigureNoise& f) { return f.is_noisy() && f.is_measured(); })) {
    out += "a draw takes the counts of replicate 0, and the figure is the mean of all plays\n";
  }
  if (some([](const FigureNoise& f) { return f.means().name.ends_with("_per_mm2"); })) {
    out += "area is nominal in all draws\n";
  }
  return out;
}

}  // namespace tools::results
