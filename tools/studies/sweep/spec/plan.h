#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "tools/studies/sweep/spec/conditions.h"
#include "tools/studies/sweep/spec/point_keys.h"
#include "tools/studies/sweep/spec/spec.h"
#include "tools/studies/sweep/spec/subset.h"

namespace tools::sweep {

/// Makes points of a space one by one.
class Planner {
 public:
  /// Files that the spec names are seen from `folder`. InputError, with its position in the spec, for a value that is
  /// not allowed.
  Planner(Spec spec, const std::filesystem::path& folder);
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  std::vector<std::uint32_t> sizes() const;  ///< how many values each axis has
  bool is_wanted(const Choice& choice) const;
  /// With its keys, and n = 0; values that do not go together make a point with an error.
  Point point(const Choice& choice);
  /// The same by another tile sampling than the spec's.
  Point point(const Choice& choice, const std::string& tile_sampling);

 private:
  const Spec spec_;
  const AnyCondition excluded_{spec_.exclude, spec_.axes};
  const std::filesystem::path folder_;
  PointKeys keys_;
};

/// Told how many points of how many are planned.
using Planned = std::function<void(std::size_t points, std::size_t of)>;

/// The points of a sweep, in order, with their keys. Files that the spec names are seen from `folder`. InputError, with
/// its position in the spec, for a value that is not allowed; values that do not go together make a point with an
/// error.
std::vector<Point> plan(const Spec& spec, const std::filesystem::path& folder, const Planned& planned = {});

}  // namespace tools::sweep
