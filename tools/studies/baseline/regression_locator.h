#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "tools/studies/baseline/stored.h"

namespace tools {

/// The unit whose counters say most clearly that it has changed, in two runs of equal work.
struct LocatedRegression {
  std::string unit;    ///< kind of unit, "core.tni.trv", or a way between two
  std::string moved;   ///< the counter: "why.pipe 1234 -> 1267 cycles (+33)"
  double clarity = 0;  ///< 0 to 1: what else moved, the less the clearer
  bool is_clear() const { return clarity >= 0.9; }
};

/// Finds the unit whose own time moved most: units that wait for a slower unit do not work longer themselves. If no own
/// time moved, it is the way between two levels of memory, or else the unit nearest to the memory that waited longer.
/// In a run in which one thing happens at a time this is certain; the more units compete, the more move. Nothing
/// without the units' counters, or if none of them moved. The time on a way is what misses took at the upper level less
/// what the lower one took to serve them, where both counted the same misses.
std::optional<LocatedRegression> locate_regression(const Values& was, const Values& is);

/// Finds the reason, of work or of waiting, that moved most in a unit that is known to have changed (unit_of_key()).
/// It is as clear as the unit's share of all work that moved. Nothing if none of its reasons moved.
std::optional<LocatedRegression> largest_move_in(std::string_view unit, const Values& was, const Values& is);

}  // namespace tools
