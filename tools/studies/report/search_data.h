#pragma once
#include <filesystem>

#include "sim/io/json.h"

namespace tools::pages {

/// Adds what only the page of a search shows, from search.json of its folder, to the data of sweep_data(). A search on
/// several workloads has a point per machine in place of one per simulation.
///   search.sentence, fidelity, objective, checked, probability
///   search.limits          [[workload, frames, limit, value, half width, room, met, probability], ...] of the best
///   search.shares          [[workload and metric, value over limit, label], ...] of the best
///   search.scatter         {x, y, limit, rows: [[n, x, y, x low, x high, y low, y high, place, axes, band], ...]}, or
///   null search.trades          {metrics, rows: [[axis, from, to, gain, values..., breaks, values are], ...]}
///   search.trade_sentences, commands [[workload, command], ...]
void add_search(const std::filesystem::path& folder, sim::Json& page);

}  // namespace tools::pages
