#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/optimise/answer.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::optimise {
namespace {

constexpr std::size_t kMostCommands = 20, kMostNear = 20,
                      kMostNamed = 20;  // points listed in the terminal; files list all

std::string goals_text(const SearchRun& search) {
  std::vector<std::string> objectives, constraints;
  for (const Goal& goal : search.goals()) (goal.is_objective() ? objectives : constraints).push_back(goal.text());
  return fmt::format("{}{}{}", fmt::join(objectives, ", "), constraints.empty() ? "" : " with ",
                     fmt::join(constraints, ", "));
}

/// Returns the simulated machines that have metrics.
std::vector<const Trial*> done_trials(const SearchRun& search) {
  std::vector<const Trial*> all;
  for (const Trial& trial : search.trials()) {
    if (trial.status == PointStatus::kDone && !trial.is_first_look) all.push_back(&trial);
  }
  return all;
}

/// Returns as text how many machines meet each constraint on all workloads: "perf.fps >= 60: 20, area_mm2 < 1: 25".
/// Machines that were ruled out early do not count, because their other workloads are unknown.
std::string met_text(const SearchRun& search) {
  const std::vector<const Trial*> all = done_trials(search);
  std::vector<std::string> each;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    if (goal.is_objective()) continue;
    const auto met = std::ranges::count_if(all, [&](const Trial* t) {
      return t->is_on_all_workloads() && t->compared[g] && goal.is_met(*t->compared[g]);
    });
    each.push_back(fmt::format("{}: {}", goal.text(), met));
  }
  return fmt::format("{}", fmt::join(each, ", "));
}

/// Returns as text how many machines are feasible; empty without constraints.
std::string feasible_text(const SearchRun& search) {
  const std::string met = met_text(search);
  if (met.empty()) return "";
  return fmt::format("{} of {} machines meet all constraints ({})\n", search.feasible_trials().size(),
                     done_trials(search).size(), met);
}

/// Lists machines whose distance from a limit is less than half of the 95 % interval of the metric.
std::string doubtful_text(const SearchRun& search, const std::vector<const Trial*>& trials) {
  std::string text;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    if (goal.is_objective()) continue;
    std::vector<std::size_t> machines;
    for (const Trial* trial : trials) {
      if (std::abs(trial->value(g) - goal.limit) < trial->seen[g]->half_width()) {
        machines.push_back(number_of(search, *trial));
      }
    }
    if (machines.empty()) continue;
    text += fmt::format("within the noise of the limit {}: {} {}\n", goal.text(),
                        machines.size() == 1 ? "machine" : "machines", fmt::join(machines, ", "));
  }
  return text;
}

/// Lists the extrapolation warnings of the machines in `answer`, then all other machines with extrapolated metrics.
std::string extrapolations_text(const SearchRun& search, const std::vector<const Trial*>& answer) {
  std::map<std::string, std::vector<std::size_t>> lines;
  for (const Trial* trial : answer) {
    for (const std::string& line : trial->extrapolations()) lines[line].push_back(number_of(search, *trial));
  }
  std::string text;
  for (const auto& [line, machines] : lines) {
    text += fmt::format("warning: {} {}: {}\n", machines.size() == 1 ? "machine" : "machines",
                        fmt::join(machines, ", "), sim::printable(line, 500));
  }
  std::vector<std::size_t> others;
  for (const Trial* trial : done_trials(search)) {
    if (!trial->extrapolations().empty() && std::ranges::find(answer, trial) == answer.end()) {
      others.push_back(number_of(search, *trial));
    }
  }
  if (others.empty()) return text;
  const std::size_t all = others.size();
  others.resize(std::min(all, kMostNamed));
  return text + fmt::format("{}machines with extrapolated figures, which warnings[] of their reports name: {}{}\n",
                            lines.empty() ? "" : "more ", fmt::join(others, ", "),
                            all > others.size() ? fmt::format(" and {} more", all - others.size()) : "");
}

/// Returns a table of machines with half of the 95 % interval of each noisy metric and the distance to its limits.
std::string table_text(const SearchRun& search, const std::vector<const Trial*>& trials) {
  const std::vector<std::size_t> goals = shown_goals(search);
  std::vector<std::string> header = {"n"};
  for (const auto& [name, value] : trials.front()->axes) header.push_back(sim::printable(name));
  std::vector<std::vector<std::string>> columns;
  for (const std::size_t g : goals) {
    header.push_back(search.goals()[g].metric_text());
    std::vector<results::Value> values;
    for (const Trial* trial : trials) values.emplace_back(trial->value(g));
    columns.push_back(results::shown_cells(values));
    if (std::ranges::any_of(trials, [&](const Trial* t) { return t->seen[g]->standard_error() > 0; })) {
      header.emplace_back("95 %");
      std::vector<std::string>& intervals = columns.emplace_back();
      for (const Trial* trial : trials) {
        const MeasuredMetric& seen = *trial->seen[g];
        const double share = seen.value == 0 ? 0 : seen.half_width() / std::abs(seen.value);
        intervals.push_back(fmt::format("± {:.2g} %", 100 * share));
      }
    }
    for (std::size_t other = 0; other < search.goals().size(); ++other) {
      const Goal& goal = search.goals()[other];
      if (goal.is_objective() || goal.metric_text() != search.goals()[g].metric_text()) continue;
      header.push_back(goal.distance_title());
      std::vector<std::string>& distances = columns.emplace_back();
      for (const Trial* trial : trials) distances.push_back(goal.distance_text(trial->value(other)));
    }
  }
  sim::Table table(header);
  for (std::size_t t = 0; t < trials.size(); ++t) {
    std::vector<std::string> cells = {std::to_string(number_of(search, *trials[t]))};
    for (const auto& [name, value] : trials[t]->axes) cells.push_back(sim::printable(value));
    for (const std::vector<std::string>& column : columns) cells.push_back(column[t]);
    table.add_row(std::move(cells));
  }
  return table.text();
}

/// Lists machines that are within noise of the Pareto front, and names the source of the noise.
std::string near_text(const SearchRun& search) {
  const std::string noise = noise_text(search);
  if (noise.empty()) return "";
  std::vector<const Trial*> near = near_front(search);
  const char* const what = std::ranges::count_if(search.goals(), &Goal::is_objective) == 1 ? "the best" : "the front";
  if (near.empty()) return fmt::format("\nall other machines differ from {} by more than noise; {}\n", what, noise);
  std::string text = fmt::format("\n{} more machine{} equal{} {} within noise; {}\n", near.size(),
                                 near.size() == 1 ? "" : "s", near.size() == 1 ? "s" : "", what, noise);
  const std::size_t all = near.size();
  near.resize(std::min(all, kMostNear));
  text += "\n" + table_text(search, near);
  return text + (all > near.size() ? fmt::format("and {} more in history.jsonl\n", all - near.size()) : "");
}

/// Returns a table of a machine's goals on each workload: value, and for a limit of the workload alone the distance to
/// it and whether it is met.
std::string workloads_text(const SearchRun& search, const Trial& trial) {
  sim::Table table({"workload", "frames", "goal", "value", "room", "met"});
  const std::vector<WorkloadRun>& runs = trial.best_runs();
  for (std::size_t w = 0; w < runs.size(); ++w) {
    for (std::size_t g = 0; g < search.goals().size(); ++g) {
      const Goal& goal = search.goals()[g];
      if (!runs[w].is_done() || !search.evaluator().needs_workload(goal, w)) continue;
      const double value = runs[w].seen[g].value;
      const bool has_limit = goal.has_limit_per_workload();
      table.add_row({sim::printable(search.workloads()[w]), runs[w].point.tile_sampling.empty() ? "whole" : "sampled",
                     goal.text(), sim::four_digit_text(value), has_limit ? goal.distance_text(value) : "",
                     !has_limit           ? ""
                     : goal.is_met(value) ? "yes"
                                          : "NO"});
    }
  }
  return table.text();
}

std::string probabilities_text(const Answer& answer) {
  if (!answer.not_priced.empty()) return fmt::format("\nno probabilities: {}\n", answer.not_priced);
  if (!answer.odds) return "";
  std::vector<std::string> each;
  for (std::size_t g = 0; g < answer.search.goals().size(); ++g) {
    const Goal& goal = answer.search.goals()[g];
    if (!goal.is_objective()) each.push_back(fmt::format("{}: {:.0f} %", goal.text(), 100 * answer.odds->met[g]));
  }
  if (each.empty()) return "";
  const std::vector<std::optional<MeasuredMetric>>& seen = answer.best()->seen;
  const bool is_assumed =
      std::ranges::any_of(seen, [](const auto& metric) { return metric && !metric->draws && metric->assumed > 0; });
  return fmt::format("\nprobability by the noise and the bands of energy and area: {}; all: {:.0f} %\n{}",
                     fmt::join(each, ", "), 100 * answer.odds->all,
                     is_assumed ? "noise is assumed; set `replicates:` in the search file to measure it\n" : "");
}

std::string trades_text(const Answer& answer) {
  if (answer.trades.empty()) return "";
  const SearchRun& search = answer.search;
  std::string text = "\naround the best:\n";
  for (const std::string& sentence : trade_sentences(search, *answer.best(), answer.trades)) {
    text += fmt::format("  {}\n", sim::printable(sentence, 500));
  }
  std::vector<std::string> header = {"axis", "from", "to"};
  const std::vector<std::size_t> goals = shown_goals(search);
  for (const std::size_t g : goals) header.push_back(search.goals()[g].metric_text());
  header.insert(header.end(), {"breaks", "values"});
  sim::Table table(header);
  for (const Trade& trade : answer.trades) {
    std::vector<std::string> cells = {sim::printable(trade.neighbour.axis), sim::printable(trade.neighbour.from),
                                      sim::printable(trade.neighbour.to)};
    for (const std::size_t g : goals) cells.push_back(trade.values[g] ? sim::four_digit_text(*trade.values[g]) : "-");
    std::string broken = trade.breaks ? search.goals()[*trade.breaks].text() : "";
    if (!trade.broken_on.empty()) broken += " on " + sim::printable(trade.broken_on);
    cells.push_back(broken);
    cells.emplace_back(trade.is_simulated ? "simulated" : "estimated");
    table.add_row(std::move(cells));
  }
  return text + "\n" + table.text();
}

std::string check_text(const Answer& answer) {
  std::string text;
  for (const Trial& trial : answer.search.trials()) {
    if (trial.whole.empty()) continue;
    if (answer.is_checked) {
      text += fmt::format("\nmachine {}\n\n{}", number_of(answer.search, trial), workloads_text(answer.search, trial));
    } else if (!trial.is_feasible) {
      text += fmt::format("machine {} breaks a limit by whole frames\n", number_of(answer.search, trial));
    }
  }
  return answer.is_checked ? "\ncheck with whole frames:\n" + text : text;
}

std::string commands_text(const SearchRun& search, const std::vector<const Trial*>& front) {
  std::string text = "\ncommands:\n";
  for (std::size_t i = 0; i < std::min(front.size(), kMostCommands); ++i) {
    const std::vector<WorkloadRun>& runs = front[i]->best_runs();
    for (std::size_t w = 0; w < runs.size(); ++w) {
      text += fmt::format("  {:<4} {}\n", number_of(search, *front[i]), sim::printable(command_of(runs[w]), 4096));
    }
  }
  if (front.size() > kMostCommands) text += fmt::format("  and {} more in front.csv\n", front.size() - kMostCommands);
  return text;
}

std::string front_text(const Answer& answer) {
  const SearchRun& search = answer.search;
  const std::vector<const Trial*> front = search.pareto_front();
  std::string text = front.size() == 1 ? "best: " : "front of ";
  text += fmt::format("{}\nfidelity: {}\n{}\n{}", goals_text(search), search.fidelity_text(), feasible_text(search),
                      table_text(search, front));
  const bool has_limits = std::ranges::count_if(search.goals(), &Goal::is_objective) != std::ssize(search.goals());
  if (search.workloads().size() > 1 && answer.best() != nullptr && has_limits && !answer.is_checked) {
    text += "\n" + workloads_text(search, *answer.best());
  }
  for (const std::string& more : {check_text(answer), probabilities_text(answer), doubtful_text(search, front),
                                  extrapolations_text(search, front), near_text(search), trades_text(answer)}) {
    if (!more.empty()) text += more.front() == '\n' ? more : "\n" + more;
  }
  return text + commands_text(search, front);
}

/// Explains why no machine is feasible.
std::string infeasible_text(const SearchRun& search) {
  const Trial* nearest = search.least_infeasible();
  if (nearest == nullptr) return "no machine could be simulated; history.jsonl has the reasons\n";
  std::vector<std::string> missed;
  const double confidence = search.task().confidence;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    if (!nearest->seen[g]) missed.push_back(fmt::format("no value of {}", goal.metric_text()));
    if (goal.is_objective() || !nearest->compared[g] || goal.is_met(*nearest->compared[g])) continue;
    const double value = *nearest->compared[g];
    missed.push_back(fmt::format("{:.4g}{} where {} is required (room {})", value,
                                 confidence == 0 ? "" : fmt::format(" with a probability of {:g} %", 100 * confidence),
                                 goal.text(), goal.distance_text(value)));
  }
  std::vector<std::string> axes;
  for (const auto& [name, value] : nearest->axes) axes.push_back(sim::printable(name + "=" + value));
  return fmt::format(
      "none of {} machines meets the constraints; the nearest is {} ({}), with {}\nmachines that meet {}\nfidelity: "
      "{}\n{}",
      search.simulated_count(), number_of(search, *nearest), fmt::join(axes, ", "), fmt::join(missed, ", "),
      met_text(search), search.fidelity_text(), extrapolations_text(search, {nearest}));
}

}  // namespace

std::string answer_text(const Answer& answer) {
  return answer.search.pareto_front().empty() ? infeasible_text(answer.search) : front_text(answer);
}

std::string summary_text(const Answer& answer) {
  const SearchRun& search = answer.search;
  const auto count = [&](auto&& is) { return static_cast<std::uint64_t>(std::ranges::count_if(search.trials(), is)); };
  const std::uint64_t looks =
      count([](const Trial& t) { return t.is_first_look && t.status != PointStatus::kImpossible; });
  const std::uint64_t failed = count([](const Trial& t) { return t.status == PointStatus::kFailed; });
  const std::uint64_t impossible = count([](const Trial& t) { return t.status == PointStatus::kImpossible; });
  std::string text = fmt::format("{} machines simulated", search.simulated_count());
  if (looks != 0) text += fmt::format(" after {} first looks", looks);
  text += fmt::format(": {} runs computed now, {} found in the store", search.computed_count(),
                      search.stored_simulation_count());
  if (search.workloads().size() > 1) {
    text += fmt::format("; {} runs needless after the first workloads", search.skipped_count());
  }
  if (failed != 0) text += fmt::format(", {} failed", failed);
  if (impossible != 0) text += fmt::format(", {} impossible", impossible);
  const double minutes = answer.seconds / 60;
  if (search.computed_count() != 0 && minutes > 0) {
    text += fmt::format("\n{:.1f} minutes, {:.1f} machines and {:.1f} runs per minute", minutes,
                        static_cast<double>(search.simulated_count()) / minutes,
                        static_cast<double>(search.computed_count()) / minutes);
  }
  return text + "\n";
}

std::string answer_sentence(const Answer& answer) {
  const SearchRun& search = answer.search;
  const Trial* const best = answer.best();
  if (best == nullptr) {
    const std::vector<const Trial*> front = search.pareto_front();
    return front.empty() ? fmt::format("None of {} machines meets all limits.", search.simulated_count())
                         : fmt::format("{} machines are on the front.", front.size());
  }
  std::vector<std::string> axes;
  for (const auto& [name, value] : best->axes) axes.push_back(name + " " + value);
  const Goal& goal = search.goals()[0];
  return fmt::format("{} with {} has the {} {} of {} machines: {}{}.",
                     fmt::format("Machine {}", number_of(search, *best)), fmt::join(axes, ", "),
                     goal.kind == Goal::Kind::kMax ? "most" : "least", goal.metric_text(), search.simulated_count(),
                     sim::four_digit_text(best->value(0)), search.goals().size() > 1 ? ", and meets all limits" : "");
}

}  // namespace tools::optimise
