#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/spec/spec.h"

namespace tools::sweep {

/// True if a combination of axis values meets the condition. Throws InputError if two compared values have no order.
bool meets_condition(const AxisCondition& condition, std::span<const std::uint32_t> choice);

/// Tests whether a combination of axis values meets at least one of thousands of conditions. Each is indexed by the
/// term that holds for the fewest values, so that most are never evaluated. The conditions must outlive this object.
class AnyCondition {
 public:
  AnyCondition(std::span<const AxisCondition> conditions, std::span<const Axis> axes);
  bool meets_any(std::span<const std::uint32_t> choice) const;

 private:
  /// For each axis and value: the conditions that only combinations with this value can meet.
  std::vector<std::vector<std::vector<const AxisCondition*>>> by_value_;
  std::vector<const AxisCondition*> others_;  ///< conditions that cannot be indexed
};

/// Returns the distinct combinations of axis values of a sweep's subset that pass the filter `is_wanted`. Throws
/// InputError for more than a million.
/// 1. grid: all, the last axis varies fastest. random, sobol: draw until `subset.count` different combinations pass.
/// 2. latin_hypercube: draws each value of an axis equally often, then removes repeated and failing combinations.
/// `sizes`: number of values of each axis.
std::vector<Choice> choose_combinations(const Subset& subset, std::span<const std::uint32_t> sizes,
                                        const std::function<bool(const Choice&)>& is_wanted);

/// Makes the points of a sweep or a search, each from a combination of axis values.
class Planner {
 public:
  /// File names in the spec are relative to `folder`. Throws InputError, with its position in the file, for a value
  /// that is not allowed.
  Planner(Spec spec, const std::filesystem::path& folder);
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  std::vector<std::uint32_t> axis_sizes() const;  ///< number of values of each axis
  /// True if the combination meets every condition `where` of the spec and no condition `exclude`.
  bool is_wanted(const Choice& choice) const;
  /// Makes the point of a combination of axis values, with its id and the key of its recorded rays. `n` is 0. If its
  /// values contradict each other, the point has an error.
  Point make_point(const Choice& choice);
  /// Makes the point of a combination of axis values, with this tile sampling instead of that of the spec.
  Point make_point(const Choice& choice, const std::string& tile_sampling);

 private:
  const Spec spec_;
  const AnyCondition excluded_{spec_.exclude, spec_.axes};
  const std::filesystem::path folder_;
  PointKeys keys_;
};

/// Called after each planned point. `points`: points planned so far; `of`: all points.
using PlanProgress = std::function<void(std::size_t points, std::size_t of)>;

/// Plans the points of a sweep in the order of their numbers. Each point has its id and the key of its recorded rays
/// (Point::stream). Throws InputError like Planner's constructor, for values that are not allowed.
std::vector<Point> plan_points(const Spec& spec, const std::filesystem::path& folder,
                               const PlanProgress& progress = {});

}  // namespace tools::sweep
