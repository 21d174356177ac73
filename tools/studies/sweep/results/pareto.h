#pragma once
#include <functional>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// A figure and which way it is better.
struct Objective {
  Column column;
  bool most = false;  ///< more is better

  /// "PATH", "min:PATH" or "max:PATH". Without a word before it: performance, performance per watt,
  /// utilisation and PSNR are better high, all else low. InputError for paths that mean nothing.
  Objective(const Results& results, const std::string& text);
  /// The value of a point as a number; nothing if it has none.
  std::optional<double> of(std::size_t row) const;
  bool is_better(double a, double b) const { return most ? a > b : a < b; }
  std::string text() const;
};

struct ParetoFront {
  std::vector<std::size_t> rows;   ///< rows of all points on it, from the best x on
  std::vector<std::size_t> other;  ///< that have both figures and are not on it
  std::vector<std::size_t> near;   ///< those of `other` that nothing holds to be off it
  std::vector<bool> sure{};        ///< by `rows`: surely_on_front()
  /// Rows of all points that have both figures, those of the front first.
  std::vector<std::size_t> all() const;
  /// The mark of a row of the front: letters in their order, or '#' if there are not enough.
  char mark(std::size_t i) const;
};

/// Points than which no other is as good in both figures and better in one, of those that `may` be.
ParetoFront pareto_front(const Objective& x, const Objective& y, const std::vector<bool>& may);

/// Points of `front.other` that no other beats for sure: by more than the noise in each figure that has some, and being
/// as good in one that has none. A point that belongs on the front is left out with a chance of 5 % at most, for all
/// its comparisons together. `sure`: where energies are a band, whether a row is as good in both figures and better in
/// one for sure; or empty.
std::vector<std::size_t> near_front(const Objective& x, const Objective& y, const FigureNoise& x_noise,
                                    const FigureNoise& y_noise, const ParetoFront& front,
                                    const std::function<bool(std::size_t better, std::size_t worse)>& sure);

/// Points of `front.rows`, by their order, than which each other is worse in a figure by more than the noise, 95 % for
/// all comparisons of the point together.
std::vector<bool> surely_on_front(const Objective& x, const Objective& y, const FigureNoise& x_noise,
                                  const FigureNoise& y_noise, const ParetoFront& front);

/// All points as dots, those of the front by their marks, those near it as '~'.
std::string pareto_plot(const Objective& x, const Objective& y, const ParetoFront& front, std::size_t width);

struct ParetoOptions {
  std::string x, y;
  std::vector<std::string> where;
  bool csv = false;
  bool band = false;  ///< how often each point is on the front under draws of the energy tables is said, too
};

/// Plot and table, or the front as CSV.
std::string pareto_text(const Results& results, const ParetoOptions& options, std::size_t width);

}  // namespace tools::results
