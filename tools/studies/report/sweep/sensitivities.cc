#include <algorithm>
#include <cctype>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/studies/report/sweep/sweep_parts.h"
#include "tools/studies/sweep/results/best.h"
#include "tools/studies/sweep/results/sensitivity.h"

namespace tools::pages {
namespace {

constexpr const char* kMain = "totals.perf.frames_per_joule_gpu";
constexpr const char* kAsked[] = {"totals.perf.frames_per_joule_gpu", "totals.perf.fps", "totals.energy_mj.nominal",
                                  "totals.power_w.nominal", "totals.cycles"};

std::optional<results::Sensitivity> sensitivity_to(const Sweep& sweep, const std::string& metric) {
  try {
    results::Sensitivity found = results::find_sensitivity(sweep.results, metric, sweep.done());
    if (found.varies && !found.effects.empty()) return found;
  } catch (const sim::InputError&) {
    return std::nullopt;  // no point has it
  }
  return std::nullopt;
}

/// The figure that the page is about: the first that a search asks for, or frames per joule.
const Metric* main_metric(const Sweep& sweep) {
  if (sweep.task) {
    if (const Metric* const asked = sweep.metric_of_goal(0)) return asked;
  }
  const Metric* const usual = sweep.metric(kMain);
  return usual != nullptr || sweep.metrics.empty() ? usual : &sweep.metrics.front();
}

/// The figures by which points are told apart, in this order: this one, what a search asks for, what is usually asked.
std::vector<const Metric*> order_of(const Sweep& sweep, const Metric& metric) {
  std::vector<const Metric*> order = {&metric};
  for (std::size_t g = 0; g < sweep.goal_paths.size(); ++g) {
    if (const Metric* const other = sweep.metric_of_goal(g)) order.push_back(other);
  }
  for (const char* path : kAsked) {
    if (const Metric* const other = sweep.metric(path)) order.push_back(other);
  }
  return order;
}

/// The point that has the best of a figure; of equals the one that is better in another, so that it is on the front.
std::optional<std::size_t> best_row(const Sweep& sweep, const Metric& metric) {
  const std::vector<const Metric*> order = order_of(sweep, metric);
  const auto scores_of = [&](std::size_t row) {
    std::vector<double> scores;
    for (const Metric* const each : order) {
      const auto amount = results::amount_of(sweep.values_of(*each).values[row]);
      scores.push_back(!amount      ? -std::numeric_limits<double>::infinity()
                       : each->more ? amount->value
                                    : -amount->value);
    }
    return scores;
  };
  const std::vector<bool> eligible = sweep.eligible();
  std::optional<std::size_t> best;
  std::vector<double> best_scores;
  for (std::size_t row = 0; row < eligible.size(); ++row) {
    if (!eligible[row] || !results::amount_of(sweep.values_of(metric).values[row])) continue;
    std::vector<double> scores = scores_of(row);
    if (best && scores <= best_scores) continue;
    best = row;
    best_scores = std::move(scores);
  }
  return best;
}

/// "; 3 points tie with it (...)", as `sweep best` finds them.
std::string what_ties(const Sweep& sweep, const Metric& metric, std::size_t best) {
  const std::vector<bool> eligible = sweep.eligible();
  std::vector<std::size_t> candidates;
  for (std::size_t row = 0; row < eligible.size(); ++row) {
    if (eligible[row] && results::amount_of(sweep.values_of(metric).values[row])) candidates.push_back(row);
  }
  const results::FigureNoise noise(sweep.results, sweep.results.column(metric.path), candidates);
  if (!noise.is_noisy() || candidates.size() < 2) return {};
  const std::size_t ties = results::find_ties(noise, metric.more, candidates, best).size();
  return fmt::format("; {} with it by {}",
                     ties == 0   ? "no point ties"
                     : ties == 1 ? "1 point ties"
                                 : fmt::format("{} points tie", ties),
                     noise.describe());
}

std::string with_capital(std::string words) {
  words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words;
}

/// Figures of all points: the best, and the band that they are in.
void add_headlines(const Sweep& sweep, const std::vector<std::string>& paths, View& view) {
  for (const std::string& path : paths) {
    const Metric& metric = *sweep.metric(path);
    const std::optional<std::size_t> best = best_row(sweep, metric);
    if (!best) continue;
    const results::Column& column = sweep.values_of(metric);
    const double value = results::amount_of(column.values[*best])->value;
    Headline out{
        .id = path, .name = with_capital(metric.words), .value = value, .show = metric.show, .unit = metric.unit};
    out.low = out.high = value;
    for (std::size_t row = 0; row < column.values.size(); ++row) {
      const auto amount = results::amount_of(column.values[row]);
      if (!sweep.results.rows()[row].is_done() || !amount) continue;
      out.low = std::min(out.low.get<double>(), amount->value);
      out.high = std::max(out.high.get<double>(), amount->value);
    }
    out.note = fmt::format("the {} of {} points, of point {}; band of all", metric.more ? "most" : "least",
                           sweep.has_constraints() ? "eligible" : "all", sweep.results.rows()[*best].n);
    view.headline(out);
  }
}

/// The figure that the page is about, and those that are usually asked for.
std::vector<std::string> asked_of(const Sweep& sweep) {
  std::vector<std::string> asked;
  if (const Metric* const metric = main_metric(sweep)) asked.push_back(metric->path);
  for (const char* path : kAsked) {
    if (sweep.metric(path) != nullptr && std::ranges::count(asked, path) == 0) asked.emplace_back(path);
  }
  return asked;
}

std::string axes_text(const Sweep& sweep, std::size_t row) {
  std::vector<std::string> words;
  for (const results::Column& axis : sweep.axes)
    words.push_back(sim::printable(fmt::format("{} {}", axis.name, results::exact_text(axis.values[row]))));
  return fmt::format("{}", fmt::join(words, ", "));
}

/// "62 % of its variance (95 %: 58 to 66 %)"
std::string share_text(const results::Effect& effect) {
  const std::string share = fmt::format("{:.0f} % of its variance", 100 * effect.share);
  if (effect.low == effect.high) return share;
  return fmt::format("{} (95 %: {:.0f} to {:.0f} %)", share, 100 * effect.low, 100 * effect.high);
}

/// The axis that explains most of a figure, as far as the points tell.
std::string what_decides(const results::Sensitivity& found, const std::string& figure) {
  const std::string points = fmt::format("{}{}", counted(static_cast<double>(found.points), "point"),
                                         found.is_grid ? "" : " (not a full grid)");
  const results::Effect& first = found.effects.front();
  const results::Effect* const second = found.effects.size() > 1 ? &found.effects[1] : nullptr;
  if (second != nullptr && first.low <= second->high) {
    return fmt::format("{} cannot tell whether {} depends most on {} or on {}: {} explains {}, {} {}.", points, figure,
                       first.axis, second->axis, first.axis, share_text(first), second->axis, share_text(*second));
  }
  return fmt::format("{} depends most on {}, which explains {} over {}.", with_capital(figure), first.axis,
                     share_text(first), points);
}

}  // namespace

void add_sweep_verdict(const Sweep& sweep, View& view) {
  const std::size_t all = sweep.results.rows().size();
  const std::vector<bool> done = sweep.done();
  const auto finished = static_cast<std::size_t>(std::ranges::count(done, true));
  if (!sweep.question.empty()) view.fact("Question", sweep.question);
  view.fact("Points", finished == all ? fmt::format("{}", all) : fmt::format("{} of {}", finished, all));
  std::vector<std::string> axes;
  for (const results::Column& axis : sweep.axes) axes.push_back(axis.name);
  view.fact("Axes", axes.empty() ? "none" : fmt::format("{}", fmt::join(axes, ", ")));
  if (sweep.task) {
    std::vector<std::string> goals;
    for (const optimise::Goal& goal : sweep.task->goals) goals.push_back(goal.text());
    view.fact("Asked for", fmt::format("{}", fmt::join(goals, ", ")));
  }
  if (const std::string missing = sweep.results.missing_text(); !missing.empty()) view.notice(missing);
  const std::vector<std::pair<std::string, std::string>> links = {{"the front", "front"},
                                                                  {"what each axis does", "sensitivity"}};
  const Metric* const metric = main_metric(sweep);
  const std::optional<std::size_t> best = metric != nullptr ? best_row(sweep, *metric) : std::nullopt;
  add_extrapolations(sweep, best, view);
  add_limits(sweep, best, view);
  if (!best) {
    return view.verdict(finished > 0 && sweep.has_constraints() ? "No point that has a result meets the constraints."
                                                                : "No point of this sweep has a result yet.",
                        "", {{"the points", "front"}});
  }
  add_headlines(sweep, asked_of(sweep), view);
  const double value = results::amount_of(sweep.values_of(*metric).values[*best])->value;
  const std::string more = fmt::format("Best: point {} with {} {} ({}){}.", sweep.results.rows()[*best].n,
                                       number_text(value), metric->unit.empty() ? metric->words : metric->unit,
                                       axes_text(sweep, *best), what_ties(sweep, *metric, *best));
  const std::optional<results::Sensitivity> found = sensitivity_to(sweep, metric->path);
  if (!found) {
    return view.verdict(fmt::format("No axis changes {}.", metric->words), more, {{"the front", "front"}});
  }
  view.verdict(what_decides(*found, metric->words), more, links);
}

void add_sensitivities(const Sweep& sweep, View& view) {
  Section section(
      "sensitivity", "What each axis does on its own",
      "The share of a figure's variance over all points that an axis explains, all others averaged; what is left "
      "of 100 % axes do only together, or noise does.");
  Dataset data({{"metric", "figure"},
                {"axis", "axis"},
                {"share", "share of variance", Show::kPercent},
                {"label", "shown"},
                {"low", "95 % from", Show::kPercent},
                {"high", "95 % to", Show::kPercent},
                {"range", "range of means", Show::kPercent},
                {"levels", "values", Show::kNumber}});
  std::string note;
  for (const std::string& path : asked_of(sweep)) {
    const std::optional<results::Sensitivity> found = sensitivity_to(sweep, path);
    if (!found) continue;
    if (!found->is_grid) note = "The points are no full grid: shares are estimates.";
    for (const results::Effect& effect : found->effects) {
      data.row({sweep.metric(path)->words, sim::printable(effect.axis), effect.share,
                fmt::format("{:.0f} %", 100 * effect.share), effect.low, effect.high, effect.range,
                effect.levels.size()});
    }
  }
  if (data.empty()) {
    section.text("No figure changes with any axis.");
    return view.add(section);
  }
  if (!note.empty()) section.text(note);
  view.data("sensitivity", data);
  section.chart("shares", "Shares of variance", "Share of the variance of each figure that each axis explains",
                "sensitivity", {{"kind", "sensitivity"}});
  section.table("shares-table", "Shares with their intervals", "sensitivity");
  view.add(section);
}

}  // namespace tools::pages
