#include "tools/studies/optimise/trade.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/report/table.h"

namespace tools::optimise {
namespace {

constexpr double kNoLoss = 0.005;  // largest relative loss of the objective that counts as none

/// Returns by how much a value breaks a limit, as a share of the limit; negative if the limit is met.
double violation_of(const Goal& goal, double value) { return -goal.distance_to_limit(value); }

/// Returns, for a machine's goal, the nominal value divided by the value that is compared with the limit.
double nominal_share(const Trial& trial, std::size_t goal) {
  const bool is_same = !trial.seen[goal] || !trial.compared[goal] || *trial.compared[goal] == 0;
  return is_same ? 1 : trial.value(goal) / *trial.compared[goal];
}

std::string setting_text(const Neighbour& neighbour) {
  return fmt::format("{} {} instead of {}", neighbour.axis, neighbour.to, neighbour.from);
}

Trade trade_of(const SearchRun& search, const Trial& best, Neighbour neighbour) {
  Trade trade;
  const Trial* const trial = neighbour.trial;
  trade.is_simulated = trial != nullptr && trial->status == PointStatus::kDone;
  double most = 0;
  bool is_known = true;
  std::size_t broken = 0;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    // If a confidence is required, a quantile is compared with the limit, and the surrogates estimate it.
    std::optional<double> value, compared;
    if (trade.is_simulated && trial->seen[g]) {
      value = trial->value(g);
      compared = goal.is_objective() ? value : trial->compared[g];
    } else if (neighbour.estimates[g]) {
      compared = neighbour.estimates[g]->mean;
      value = *compared * nominal_share(best, g);
    }
    trade.values.push_back(value);
    is_known = is_known && value && compared;
    if (!compared || goal.is_objective() || goal.is_met(*compared)) continue;
    broken += 1;
    const double violation = violation_of(goal, *compared);
    if (trade.breaks && violation <= most) continue;
    most = violation;
    trade.breaks = g;
    trade.reached = *compared;
    if (trade.is_simulated) trade.broken_on = binding_workload(search, *trial, g);
  }
  trade.breaks_one = broken == 1 && is_known && (!trade.is_simulated || trial->is_on_all_workloads());
  trade.is_feasible = trade.is_simulated ? trial->is_feasible : is_known && !trade.breaks;
  if (trade.values[0]) {
    const double change = *trade.values[0] - best.value(0);
    trade.gain = search.goals()[0].kind == Goal::Kind::kMax ? change : -change;
  }
  trade.neighbour = std::move(neighbour);
  return trade;
}

}  // namespace

std::vector<Trade> trades_of(SearchRun& search, const Trial& best) {
  std::vector<Trade> trades;
  for (Neighbour& neighbour : search.neighbours_of(best)) {
    const bool is_impossible = neighbour.trial != nullptr && neighbour.trial->status == PointStatus::kImpossible;
    if (!is_impossible) trades.push_back(trade_of(search, best, std::move(neighbour)));
  }
  std::ranges::stable_sort(trades, std::greater{}, &Trade::gain);
  return trades;
}

std::optional<std::size_t> binding_limit(const SearchRun& search, const Trial& best) {
  std::optional<std::size_t> binding;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    if (goal.is_objective() || !best.seen[g]) continue;
    if (!binding ||
        goal.distance_to_limit(best.value(g)) < search.goals()[*binding].distance_to_limit(best.value(*binding))) {
      binding = g;
    }
  }
  return binding;
}

std::string binding_workload(const SearchRun& search, const Trial& trial, std::size_t goal) {
  const Goal& limit = search.goals()[goal];
  const bool is_worst = limit.fold == sweep::SetMetric::Kind::kWorst;
  const bool has_one = limit.has_limit_per_workload() || is_worst;
  if (search.workloads().size() == 1 || !has_one || sweep::is_metric_of_machine(limit.metric)) return "";
  std::optional<std::size_t> nearest;
  const std::vector<WorkloadRun>& runs = trial.best_runs();
  for (std::size_t w = 0; w < runs.size(); ++w) {
    if (!runs[w].is_done() || !search.evaluator().needs_workload(limit, w)) continue;
    const auto distance = [&](std::size_t at) {
      const double value = runs[at].seen[goal].value;
      if (is_worst) return limit.is_larger_better() ? value : -value;
      return limit.distance_to_limit(value);
    };
    if (!nearest || distance(w) < distance(*nearest)) nearest = w;
  }
  return nearest ? search.workloads()[*nearest] : "";
}

std::vector<std::string> trade_sentences(const SearchRun& search, const Trial& best, const std::vector<Trade>& trades) {
  std::vector<std::string> out;
  const Goal& objective = search.goals()[0];
  const std::string name = objective.metric_text();
  const auto amount = [](double value) { return sim::four_digit_text(std::abs(value)); };
  const std::optional<std::size_t> binding = binding_limit(search, best);
  if (binding) {
    const Goal& goal = search.goals()[*binding];
    const std::string on = binding_workload(search, best, *binding);
    out.push_back(fmt::format("{} binds{}: its room is {}", goal.text(), on.empty() ? "" : " on " + on,
                              goal.distance_text(best.value(*binding))));
  }
  // For each limit: the neighbour that gains most per unit by which it breaks the limit.
  std::map<std::size_t, const Trade*> relaxed;
  const auto price = [&](const Trade& t) { return t.gain / violation_of(search.goals()[*t.breaks], t.reached); };
  for (const Trade& trade : trades) {
    if (trade.gain <= 0 || !trade.breaks_one) continue;
    const Trade*& at = relaxed[*trade.breaks];
    if (at == nullptr || price(trade) > price(*at)) at = &trade;
  }
  for (const auto& [g, trade] : relaxed) {
    const Goal& goal = search.goals()[g];
    out.push_back(fmt::format("{} of {} would allow {} ({} {} {}){}", goal.metric_text(), amount(trade->reached),
                              setting_text(trade->neighbour), amount(trade->gain),
                              objective.kind == Goal::Kind::kMax ? "more" : "less", name,
                              trade->is_simulated ? "" : ", estimated"));
  }
  const Trade* bought = nullptr;
  const auto room_gained = [&](const Trade& t) {
    const Goal& goal = search.goals()[*binding];
    return t.values[*binding]
               ? goal.distance_to_limit(*t.values[*binding]) - goal.distance_to_limit(best.value(*binding))
               : 0;
  };
  for (const Trade& trade : trades) {
    if (!binding || trade.gain >= 0 || !trade.is_feasible || room_gained(trade) <= 0) continue;
    if (bought == nullptr || room_gained(trade) / -trade.gain > room_gained(*bought) / -bought->gain) bought = &trade;
  }
  if (bought != nullptr) {
    const Goal& goal = search.goals()[*binding];
    const double change = *bought->values[*binding] - best.value(*binding);
    out.push_back(fmt::format("the cheapest room: {} changes {} by {:+.3g} for {} {} {}{}",
                              setting_text(bought->neighbour), goal.metric_text(), change, amount(bought->gain),
                              objective.kind == Goal::Kind::kMax ? "less" : "more", name,
                              bought->is_simulated ? "" : ", estimated"));
  }
  std::vector<std::string> free;
  for (const Trade& trade : trades) {
    const bool is_free = trade.is_feasible && std::abs(trade.gain) <= kNoLoss * std::abs(best.value(0));
    if (is_free) free.push_back(setting_text(trade.neighbour));
  }
  if (!free.empty())
    out.push_back(fmt::format("without loss ({:.1f} % of {}): {}", 100 * kNoLoss, name, fmt::join(free, "; ")));
  return out;
}

}  // namespace tools::optimise
