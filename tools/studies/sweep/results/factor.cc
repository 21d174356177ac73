#include "tools/studies/sweep/results/factor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "sim/io/printable.h"

namespace tools::results {
namespace {

constexpr std::size_t kMostGroups = 6;

struct Before {
  bool operator()(const Value& a, const Value& b) const { return is_before(a, b); }
};

Factor factor_of(const Column& column, const std::vector<std::size_t>& rows) {
  std::map<Value, std::size_t, Before> levels;
  for (const std::size_t row : rows) levels.emplace(column.values[row], 0);
  Factor factor{column.name, {}, {}};
  for (auto& [value, number] : levels) {
    number = factor.levels.size();
    factor.levels.push_back(is_absent(value) ? "-" : sim::printable(exact_text(value)));
  }
  for (const std::size_t row : rows) factor.at.push_back(levels.at(column.values[row]));
  return factor;
}

/// Do two axes part the points in the same way? If no two points share a value, only if their order is the same, too.
bool move_together(const Factor& a, const Factor& b) {
  if (a.levels.size() != b.levels.size()) return false;
  if (a.levels.size() == a.at.size()) return a.at == b.at;
  std::vector<std::size_t> partner(a.levels.size(), a.levels.size());
  for (std::size_t i = 0; i < a.at.size(); ++i) {
    std::size_t& of_a = partner[a.at[i]];
    if (of_a == a.levels.size()) of_a = b.at[i];
    if (of_a != b.at[i]) return false;
  }
  return true;  // as many levels on both sides
}

void join_those_that_move_together(std::vector<Factor>& factors) {
  for (std::size_t i = 0; i < factors.size(); ++i) {
    Factor& a = factors[i];
    for (std::size_t k = i + 1; k < factors.size();) {
      Factor& b = factors[k];
      if (!move_together(a, b)) {
        ++k;
        continue;
      }
      a.name += " + " + b.name;
      std::vector<std::string> joined = a.levels;
      for (std::size_t p = 0; p < a.at.size(); ++p) joined[a.at[p]] = a.levels[a.at[p]] + " / " + b.levels[b.at[p]];
      a.levels = std::move(joined);
      factors.erase(factors.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }
}

bool is_grid(const std::vector<Factor>& factors, std::size_t points) {
  std::size_t combinations = 1;
  for (const Factor& factor : factors) {
    combinations *= factor.levels.size();
    if (combinations > points) return false;
  }
  std::set<std::vector<std::size_t>> there;
  for (std::size_t i = 0; i < points; ++i) {
    std::vector<std::size_t> levels;
    for (const Factor& factor : factors) levels.push_back(factor.at[i]);
    there.insert(std::move(levels));
  }
  return combinations == points && there.size() == points;
}

/// Takes neighbours together, into groups of about as many points.
void group(Factor& factor, std::size_t groups) {
  std::vector<std::size_t> count(factor.levels.size()), group_of(factor.levels.size());
  for (const std::size_t level : factor.at) ++count[level];
  std::size_t before = 0;
  for (std::size_t level = 0; level < count.size(); ++level) {
    group_of[level] = (2 * before + count[level]) * groups / (2 * factor.at.size());
    before += count[level];
  }
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < count.size();) {
    std::size_t end = begin;
    while (end < count.size() && group_of[end] == group_of[begin]) ++end;
    names.push_back(end - begin == 1 ? factor.levels[begin]
                                     : fmt::format("{} to {}", factor.levels[begin], factor.levels[end - 1]));
    std::fill(group_of.begin() + static_cast<std::ptrdiff_t>(begin),
              group_of.begin() + static_cast<std::ptrdiff_t>(end), names.size() - 1);
    begin = end;
  }
  for (std::size_t& level : factor.at) level = group_of[level];
  factor.levels = std::move(names);
}

}  // namespace

Factors find_factors(const Results& results, const std::vector<std::size_t>& rows) {
  Factors factors;
  for (const Column& column : results.varying()) {
    Factor factor = factor_of(column, rows);
    if (factor.levels.size() > 1) factors.list.push_back(std::move(factor));
  }
  join_those_that_move_together(factors.list);
  factors.is_grid = is_grid(factors.list, rows.size());
  if (factors.is_grid) return factors;
  const auto root = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(rows.size()))));
  const std::size_t groups = std::clamp<std::size_t>(root, 2, kMostGroups);
  for (Factor& factor : factors.list) {
    if (factor.levels.size() * 3 > rows.size() * 2 && factor.levels.size() > groups) group(factor, groups);
  }
  join_those_that_move_together(factors.list);
  return factors;
}

}  // namespace tools::results
