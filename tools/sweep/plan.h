#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "tools/sweep/point.h"
#include "tools/sweep/spec.h"

namespace tools::sweep {

/// The points of a sweep, in order, with their keys. Files that the spec names are seen from `folder`. InputError, with
/// its place in the spec, for a value that is not allowed; values that do not go together make a point with an error.
std::vector<Point> plan(const Spec& spec, const std::filesystem::path& folder);

}  // namespace tools::sweep
