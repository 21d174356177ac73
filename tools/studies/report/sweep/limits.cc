#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/report/sweep/sweep_parts.h"
#include "tools/studies/sweep/results/figure_noise.h"

namespace tools::pages {
namespace {

/// The 95 % interval of a figure at a row: "± 9 %"; empty if noise does not move it.
std::string interval_text(const Sweep& sweep, const Metric& metric, const std::vector<std::size_t>& rows,
                          std::size_t row) {
  const results::FigureNoise noise(sweep.results, sweep.results.column(metric.path), rows);
  return noise.is_noisy() ? results::interval_text(noise, row) : std::string();
}

}  // namespace

void add_extrapolations(const Sweep& sweep, std::optional<std::size_t> best, View& view) {
  if (best) {
    const results::Row& row = sweep.results.rows()[*best];
    try {
      for (const std::string& line : results::extrapolation_lines(load_report(sweep.results.folder_of(row)).json)) {
        view.notice(fmt::format("Best point, {}: {}", row.n, line));
      }
    } catch (const sim::InputError&) {
      view.notice(fmt::format("Best point, {}: its report cannot be read.", row.n));
    }
  }
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < sweep.results.rows().size(); ++row) {
    if (sweep.results.rows()[row].is_done()) rows.push_back(row);
  }
  std::string note = results::extrapolated_note(sweep.results, rows);
  std::erase(note, '\n');
  if (!note.empty()) view.notice("There are " + note);
}

void add_limits(const Sweep& sweep, std::optional<std::size_t> best, View& view) {
  if (!sweep.has_constraints()) return;
  const std::vector<bool> done = sweep.done(), eligible = sweep.eligible();
  const auto all = std::ranges::count(done, true), feasible = std::ranges::count(eligible, true);
  view.fact("Feasible", fmt::format("{} of {} points", feasible, all));
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < done.size(); ++row) {
    if (done[row]) rows.push_back(row);
  }
  Dataset data({{"constraint", "constraint"},
                {"met", "points that meet it", Show::kNumber},
                {"best", "best point", Show::kNumber},
                {"interval", "95 %"},
                {"room", "room to the limit"}});
  for (std::size_t g = 0; g < sweep.task->goals.size(); ++g) {
    const optimise::Goal& goal = sweep.task->goals[g];
    const Metric* const metric = sweep.metric_of_goal(g);
    if (goal.is_objective() || metric == nullptr) continue;
    const auto value = [&](std::size_t row) { return results::amount_of(sweep.values_of(*metric).values[row]); };
    const auto met =
        std::ranges::count_if(rows, [&](std::size_t row) { return value(row) && goal.is_met(value(row)->value); });
    std::vector<Json> cells = {goal.text(), met, Json(), "", ""};
    if (best && value(*best)) {
      cells[2] = value(*best)->value;
      cells[3] = interval_text(sweep, *metric, rows, *best);
      cells[4] = goal.room_text(value(*best)->value);
    }
    data.row(std::move(cells));
  }
  view.data("limits", data);
  Section section(
      "limits", "Limits",
      fmt::format("{} of {} points meet all constraints. Room is the distance of the best point from a limit, "
                  "as a share of the limit.",
                  feasible, all));
  section.table("limits-table", "Constraints, and the best point's room", "limits");
  view.add(section);
}

}  // namespace tools::pages
