#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/spec/spec.h"

namespace tools::sweep {

/// True if the combination meets the condition. Throws InputError if two compared values have no order.
bool meets_condition(const AxisCondition& condition, std::span<const std::uint32_t> choice);

/// Tests whether any of many conditions holds. Conditions are indexed by the term that holds for the fewest values, so
/// that most are never evaluated: a small file can have thousands. The conditions must outlive this object.
class AnyCondition {
 public:
  AnyCondition(std::span<const AxisCondition> conditions, std::span<const Axis> axes);
  bool meets_any(std::span<const std::uint32_t> choice) const;

 private:
  /// Conditions that require a value of an axis, by axis and by that value.
  std::vector<std::vector<std::vector<const AxisCondition*>>> by_value_;
  std::vector<const AxisCondition*> others_;  ///< conditions without a known term
};

/// Returns the combinations of axis values of a subset of a sweep that pass the filter, each once; a grid in order, the
/// last axis fastest. Throws InputError for more than a million.
/// 1. random and sobol draw until `subset.count` different combinations pass.
/// 2. latin_hypercube draws each value of an axis equally often, then drops repeated combinations and those that fail.
/// `sizes`: number of values of each axis.
std::vector<Choice> choose_combinations(const Subset& subset, std::span<const std::uint32_t> sizes,
                                        const std::function<bool(const Choice&)>& is_wanted);

/// Makes the points of a sweep or a search, one for each combination of axis values.
class Planner {
 public:
  /// Files that the spec names are relative to `folder`. Throws InputError, with its position in the file, for a value
  /// that is not allowed.
  Planner(Spec spec, const std::filesystem::path& folder);
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  std::vector<std::uint32_t> axis_sizes() const;  ///< number of values of each axis
  /// True if the combination meets every condition `where` of the spec and no condition `exclude`.
  bool is_wanted(const Choice& choice) const;
  /// Makes the point of a combination of axis values, with its keys and n = 0. If its values contradict each other, the
  /// point has an error.
  Point make_point(const Choice& choice);
  /// Makes the point of a combination of axis values, with this tile sampling instead of that of the spec.
  Point make_point(const Choice& choice, const std::string& tile_sampling);

 private:
  const Spec spec_;
  const AnyCondition excluded_{spec_.exclude, spec_.axes};
  const std::filesystem::path folder_;
  PointKeys keys_;
};

/// Called after each planned point with the numbers of planned points and of all points.
using PlanProgress = std::function<void(std::size_t points, std::size_t of)>;

/// Plans the points of a sweep, in order. Each point has its id and the key of its recorded work (Point::stream).
/// Throws InputError like Planner's constructor, for values that are not allowed.
std::vector<Point> plan_points(const Spec& spec, const std::filesystem::path& folder,
                               const PlanProgress& progress = {});

}  // namespace tools::sweep
