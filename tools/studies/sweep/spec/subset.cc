#include "tools/studies/sweep/spec/subset.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <boost/random/sobol.hpp>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/hash.h"

namespace tools::sweep {
namespace {

constexpr std::uint64_t kMostPoints = 1'000'000;
constexpr std::uint64_t kMostDraws = 1U << 20;  // for those that are wanted; about a second

/// The value that a number of 32 bits falls on: each gets an equal share of them.
std::uint32_t slot(std::uint32_t number, std::uint32_t values) {
  return static_cast<std::uint32_t>((std::uint64_t{number} * values) >> 32);
}

std::uint64_t grid_size(std::span<const std::uint32_t> sizes) {
  std::uint64_t size = 1;
  for (const std::uint32_t values : sizes) size = std::min<std::uint64_t>(size * values, std::uint64_t{1} << 40);
  return size;
}

std::vector<Choice> grid(std::span<const std::uint32_t> sizes, const std::function<bool(const Choice&)>& is_wanted) {
  if (grid_size(sizes) > kMostPoints) {
    throw sim::InputError(fmt::format(
        "the grid has more than {} points; allowed: a subset, e.g. 'subset: {{sobol: 1000}}'", kMostPoints));
  }
  std::vector<Choice> all;
  Choice choice(sizes.size(), 0);
  for (;;) {
    if (is_wanted(choice)) all.push_back(choice);
    std::size_t axis = sizes.size();
    while (axis != 0 && ++choice[axis - 1] == sizes[axis - 1]) choice[--axis] = 0;
    if (axis == 0) return all;
  }
}

/// Draws until there are `count` different ones that are wanted.
template <class Draw>
std::vector<Choice> draw_until(std::uint64_t count, const std::function<bool(const Choice&)>& is_wanted, Draw&& draw) {
  std::vector<Choice> all;
  std::set<Choice> drawn;
  for (std::uint64_t i = 0; i < kMostDraws && all.size() < count; ++i) {
    Choice choice = draw(i);
    if (is_wanted(choice) && drawn.insert(choice).second) all.push_back(std::move(choice));
  }
  return all;
}

std::vector<Choice> latin_hypercube(const Subset& subset, std::span<const std::uint32_t> sizes,
                                    const std::function<bool(const Choice&)>& is_wanted) {
  std::vector<Choice> all(subset.count, Choice(sizes.size()));
  std::vector<std::uint32_t> order(subset.count);
  for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(sim::hash(subset.seed, axis, i), i); });
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i][axis] = static_cast<std::uint32_t>(std::uint64_t{order[i]} * sizes[axis] / subset.count);
    }
  }
  std::set<Choice> seen;
  std::erase_if(all, [&](const Choice& choice) { return !seen.insert(choice).second || !is_wanted(choice); });
  return all;
}

}  // namespace

std::vector<Choice> choose(const Subset& subset, std::span<const std::uint32_t> sizes,
                           const std::function<bool(const Choice&)>& is_wanted) {
  if (subset.kind == Subset::Kind::kGrid || sizes.empty()) return grid(sizes, is_wanted);
  if (subset.kind == Subset::Kind::kLatinHypercube) return latin_hypercube(subset, sizes, is_wanted);
  const bool takes_all = grid_size(sizes) <= subset.count;  // drawing would not find the last ones soon
  if (takes_all) return grid(sizes, is_wanted);
  Choice choice(sizes.size());
  if (subset.kind == Subset::Kind::kRandom) {
    return draw_until(subset.count, is_wanted, [&](std::uint64_t i) {
      for (std::size_t a = 0; a < sizes.size(); ++a) {
        choice[a] = slot(static_cast<std::uint32_t>(sim::hash(subset.seed, i, a) >> 32), sizes[a]);
      }
      return choice;
    });
  }
  boost::random::sobol sequence(sizes.size());  // 64 bits a number, one after the other for each axis
  return draw_until(subset.count, is_wanted, [&](std::uint64_t) {
    for (std::size_t a = 0; a < sizes.size(); ++a) {
      const std::uint64_t shift = sim::hash(subset.seed, a);  // keeps the sequence's evenness
      choice[a] = slot(static_cast<std::uint32_t>((sequence() ^ shift) >> 32), sizes[a]);
    }
    return choice;
  });
}

}  // namespace tools::sweep
