#include "tools/studies/optimise/search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>

#include "sim/hash.h"
#include "tools/studies/optimise/nsga2.h"
#include "tools/studies/optimise/search_models.h"
#include "tools/studies/sweep/spec/plan.h"

namespace tools::optimise {
namespace {

constexpr std::uint64_t kSmallSpace = 1U << 12;  // points that are listed: each of them is a candidate
constexpr std::uint64_t kMostDraws = 1U << 20;   // for points of a larger space that are wanted
constexpr std::uint32_t kGenerations = 30;       // generations of NSGA-II
constexpr std::size_t kRandom = 32;              // candidates beside what NSGA-II brings
constexpr std::size_t kRanked = 64;              // candidates that are rated again after each choice for a batch
constexpr double kForbidden = 1e9, kKnown = 1e6, kInfeasible = 3;  // penalties; scores are about 0 to 1
constexpr double kHopeless = 1e5;  // largest fitness of an unknown point; NSGA-II needs finite numbers

/// Points in an order that the seed alone decides, so that of equally good ones no corner of the space is first.
void shuffle(std::vector<Choice>& points, std::uint64_t seed) {
  std::ranges::sort(points, {}, [&](const Choice& point) {
    std::uint64_t h = seed;
    for (const std::uint32_t value : point) h = sim::hash(h, value);
    return std::pair(h, point);
  });
}

/// 0 to 1: 0 if the point is feasible with a number of deviations of luck.
double infeasibility(double log_feasible, double optimism) {
  const double short_of = std::max(log_normal_cdf(-optimism) - log_feasible, 0.0);
  return std::isfinite(short_of) ? short_of / (1 + short_of) : 1;
}

}  // namespace

Search::Search(Space space, std::vector<Goal> goals, const Options& options)
    : space_(std::move(space)),
      goals_(std::move(goals)),
      options_(options),
      figures_(goals_.size()),
      errors_(goals_.size()),
      looks_(goals_.size()) {
  objectives_ = static_cast<std::size_t>(std::ranges::count_if(goals_, &Goal::is_objective));
  for (std::size_t g = 0; g <= goals_.size(); ++g) surrogates_.emplace_back(space_.axes);
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    if (!goals_[g].is_objective() && !(goals_[g].limit > 0)) surrogates_[g].forbid_log();
  }
  std::uint64_t points = 1;
  for (std::size_t a = 0; a < space_.axes.size(); ++a) {
    sizes_.push_back(space_.axes[a].values);
    if (sizes_.back() > 1) genes_.push_back(a);
    points = std::min(points * sizes_.back(), 2 * kSmallSpace);
  }
  if (points <= kSmallSpace) all_ = sweep::choose_combinations({}, sizes_, space_.is_wanted);
}

Score Search::score_of(const std::vector<double>& figures) const {
  Score score;
  for (std::size_t o = 0; o < objectives_; ++o) {
    score.push_back(goals_[o].kind == Goal::Kind::kMax ? figures[o] : -figures[o]);
  }
  return score;
}

void Search::tell(const Choice& point, const std::optional<std::vector<double>>& figures,
                  const std::vector<double>& errors, bool are_bounds) {
  if (!told_.emplace(point, figures.has_value()).second || !figures) return;
  errors_are_bounds_ = errors_are_bounds_ || are_bounds;
  bool is_feasible = true;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    figures_[g].emplace(point, figures->at(g));
    if (!errors.empty() && errors.at(g) > 0) errors_[g].emplace(point, errors[g]);
    is_feasible = is_feasible && goals_[g].is_met(figures->at(g));
  }
  if (is_feasible) scores_.emplace(point, score_of(*figures));
}

void Search::tell_look(const Choice& point, const std::vector<double>& figures) {
  for (std::size_t g = 0; g < goals_.size(); ++g) looks_[g].emplace(point, figures.at(g));
}

/// Any point of the grid.
Choice Search::draw() {
  Choice point(sizes_.size());
  ++draws_;
  for (std::size_t a = 0; a < sizes_.size(); ++a) {
    point[a] = static_cast<std::uint32_t>(((sim::hash(options_.seed, draws_, a) >> 32) * sizes_[a]) >> 32);
  }
  return point;
}

void Search::add_random(std::size_t count, std::set<Choice>& points) {
  const auto add = [&](const Choice& point) {
    if (is_new(point) && points.insert(point).second) --count;
  };
  for (std::uint64_t d = 0; d < (all_.empty() ? kMostDraws : 4 * count) && count != 0; ++d) add(draw());
  if (count == 0 || all_.empty()) return;
  std::vector<std::size_t> order(all_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::uint64_t seed = sim::hash(options_.seed, ++draws_);
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(sim::hash(seed, i), i); });
  for (std::size_t i = 0; i < order.size() && count != 0; ++i) add(all_[order[i]]);
}

/// A Latin hypercube and two opposite corners.
std::vector<Choice> Search::spread(std::size_t count) {
  std::set<Choice> points;
  Choice low(sizes_.size(), 0), high = low;
  for (std::size_t a = 0; a < sizes_.size(); ++a) high[a] = sizes_[a] - 1;
  for (const Choice& corner : {low, high}) {
    if (points.size() < count && is_new(corner)) points.insert(corner);
  }
  if (points.size() < count) {
    const sweep::Subset subset{sweep::Subset::Kind::kLatinHypercube, count - points.size(),
                               sim::hash(options_.seed, told_.size())};
    for (const Choice& point : sweep::choose_combinations(subset, sizes_, space_.is_wanted)) {
      if (points.size() < count && is_new(point)) points.insert(point);
    }
  }
  add_random(count - points.size(), points);
  return {points.begin(), points.end()};
}

std::vector<Choice> Search::neighbours_of_front() const {
  std::vector<Choice> points, near;
  std::vector<Score> scores;
  for (const auto& [point, score] : scores_) {
    points.push_back(point);
    scores.push_back(score);
  }
  for (const std::size_t i : pareto_front_of(scores)) {
    for (const std::size_t a : genes_) {
      const std::uint32_t here = points[i][a];
      for (std::uint32_t value = 0; value < sizes_[a]; ++value) {
        const bool is_next = value + 1 == here || value == here + 1;
        if (value == here || (space_.axes[a].ordered && !is_next)) continue;
        near.push_back(points[i]);
        near.back()[a] = value;
      }
    }
  }
  return near;
}

/// NSGA-II on the estimates. With one objective the other is to know little, so that both what is good and what is
/// uncertain is found.
std::vector<Choice> Search::evolve(Models& models, double optimism, std::uint64_t seed) {
  if (genes_.empty()) return {};
  const auto to_point = [&](const Choice& genes) {
    Choice point(sizes_.size(), 0);
    for (std::size_t g = 0; g < genes_.size(); ++g) point[genes_[g]] = genes[g];
    return point;
  };
  GeneticTask task;
  for (const std::size_t a : genes_) task.values.push_back(sizes_[a]);
  task.generations = kGenerations;
  task.seed = static_cast<std::uint32_t>(sim::hash(options_.seed, told_.size(), seed));
  task.fitness = [&](std::span<const Choice> generation) {
    std::vector<double> fitness;
    for (const Choice& genes : generation) {
      const Choice point = to_point(genes);
      const Models::Estimated& e = models.at(point);
      const double known = !space_.is_wanted(point) ? kForbidden : told_.contains(point) ? kKnown : 0;
      const double penalty = known + kInfeasible * infeasibility(e.log_feasible, optimism);
      fitness.push_back(objectives_ == 2 ? penalty - models.score(e, 0, optimism)
                                         : known + std::min(-models.log_promise(point), kHopeless));
      fitness.push_back(penalty - models.score(e, objectives_ - 1, optimism));
    }
    return fitness;
  };
  std::vector<Choice> begin = neighbours_of_front();
  std::erase_if(begin, [&](const Choice& point) { return !is_new(point); });
  shuffle(begin, task.seed);
  begin.resize(std::min<std::size_t>(begin.size(), options_.population / 2));
  while (begin.size() < options_.population) begin.push_back(draw());
  for (const Choice& point : begin) {
    Choice genes;
    for (const std::size_t a : genes_) genes.push_back(point[a]);
    task.begin.push_back(std::move(genes));
  }
  std::vector<Choice> points;
  for (const Choice& genes : nsga2().run(task)) points.push_back(to_point(genes));
  return points;
}

/// Points that may be proposed: all of a small space, of a large one what NSGA-II and neighbourhoods bring.
std::vector<Choice> Search::candidates(Models& models, std::size_t count) {
  std::set<Choice> points;
  const auto add = [&](const std::vector<Choice>& more) {
    std::ranges::copy_if(more, std::inserter(points, points.end()), [&](const Choice& p) { return is_new(p); });
  };
  if (!all_.empty()) {
    add(all_);
  } else {
    add(evolve(models, 0, 0));
    add(evolve(models, 1.5, 1));
    add(neighbours_of_front());
    add_random(std::max(kRandom, count), points);
  }
  return {points.begin(), points.end()};
}

std::vector<Choice> Search::propose(std::size_t count) {
  if (figures_.front().empty()) return spread(count);
  Models models(*this);
  std::vector<Choice> open = candidates(models, count), chosen;
  shuffle(open, sim::hash(options_.seed, told_.size()));
  const auto promise = [&](const Choice& point) { return models.log_promise(point); };
  std::ranges::stable_sort(open, std::greater{}, promise);
  open.resize(std::min(open.size(), std::max(kRanked, count)));
  while (chosen.size() < count && !open.empty()) {
    const auto best = std::ranges::max_element(open, {}, promise);
    models.believe(*best);
    chosen.push_back(*best);
    open.erase(best);
  }
  return chosen;
}

}  // namespace tools::optimise
