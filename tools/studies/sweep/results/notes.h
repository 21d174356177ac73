#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/results.h"

namespace sim {
class Json;
}

namespace tools::results {

// Lines on how an answer is to be read, or nothing.

/// The points among `rows` of which figures of energy, area or latency lie beyond the curves of their tables.
std::string extrapolated_note(const Results& results, const std::vector<std::size_t>& rows);

/// The lines of `warnings[]` of a report that has extrapolated figures; none if it has none.
std::vector<std::string> extrapolation_lines(const sim::Json& report);

/// Limits of draws of the energy tables for figures: they know no noise, have the counts of one play and leave area as
/// it is.
std::string draws_note(const std::vector<const FigureNoise*>& figures);

}  // namespace tools::results
