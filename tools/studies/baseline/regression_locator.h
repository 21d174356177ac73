#pragma once
#include <optional>
#include <string>

#include "tools/studies/baseline/stored.h"

namespace tools {

/// The unit that is most likely to have changed, by what two runs of equal work say.
struct LocatedRegression {
  std::string unit;    ///< kind of unit, "core.tni.trv", or a way between two
  std::string moved;   ///< what says so: "why.pipe 1234 -> 1267 cycles (+33)"
  double clarity = 0;  ///< 0 to 1: of all that moved, what this is
  bool is_clear() const { return clarity >= 0.9; }
};

/// Looks for the unit whose own time moved most, because what waits for a slower unit does not take longer itself. If
/// no unit's own did, it is a way between two, whose time is what the misses on one side took beyond the time of the
/// other; or the unit next to the memory that waited longer. In a run in which one thing happens at a time this is
/// certain; the more units compete, the more move. Nothing without the units' counters, or if none of them moved.
std::optional<LocatedRegression> locate_regression(const Values& was, const Values& is);

}  // namespace tools
