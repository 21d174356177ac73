#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "tools/noise/noise.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// Noise of a figure at some points of a sweep: measured if all of them have replicates of it, otherwise assumed for
/// the sizes of their pictures.
class FigureNoise {
 public:
  FigureNoise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows);

  /// Do races move the figure?
  bool is_noisy() const { return noisy_; }
  bool is_measured() const { return measured_; }
  /// Values of the points: means of the replicates, if they are measured.
  const Column& means() const { return means_; }
  /// Plays of a point; 1 without replicates.
  std::size_t plays(std::size_t row) const { return seen_[row].draws ? seen_[row].draws->count : 1; }
  /// Standard deviation of a point's value; 0 for a figure without noise.
  double error(std::size_t row) const { return seen_[row].error(); }
  /// Half of the 95 % interval of a point's value.
  double half_width(std::size_t row) const { return seen_[row].half_width(); }
  /// Chance that `b` is seen so much better than `a` if it is not.
  double chance_better(std::size_t b, std::size_t a, bool most) const;
  /// "noise measured by 5 replicates a point", "a noise of 2 %, assumed ...".
  std::string text() const;

 private:
  bool noisy_ = false, measured_ = false;
  Column means_;
  std::vector<SeenFigure> seen_;  ///< by row
  double least_ = 0, most_ = 0;   ///< range of the assumed noises, or of the plays
};

/// "± 0.52 %" of a point's value: half of its 95 % interval.
std::string give_or_take(const FigureNoise& noise, std::size_t row);

/// A column as statements take it: of each point the mean of its replicates, if it has any, else the value of its play.
/// InputError for paths that mean nothing.
Column column_of_means(const Results& results, const std::string& path);

/// Chance below which a difference is held to be real.
inline constexpr double kError = 0.05;

}  // namespace tools::results
