#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/studies/sweep/point.h"

namespace tools::sweep {

/// Shares points out: a line a task, with the ids of at most `chunk` points. Those with the same recorded work are side
/// by side, and in one task where they fit.
std::vector<std::string> task_lines(const std::vector<const Point*>& points, std::uint64_t chunk);

}  // namespace tools::sweep
