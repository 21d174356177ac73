#pragma once
#include <filesystem>

#include "sim/io/json.h"

namespace tools::pages {

/// Adds the data that only the page of a search shows to `page`, the result of sweep_data(). The data is read from
/// search.json in the folder. For a search on several workloads, the points are replaced by machines.
///   search.sentence, fidelity, objective, checked, probability
///   search.limits          [[workload, frames, limit, value, half width, room, met, probability], ...] of the best
///   search.shares          [[workload and metric, value over limit, label], ...] of the best
///   search.scatter         {x, y, limit, rows: [[n, x, y, x low, x high, y low, y high, place, axes, band], ...]}, or
///   null search.trades          {metrics, rows: [[axis, from, to, gain, values..., breaks, values are], ...]}
///   search.trade_sentences, commands [[workload, command], ...]
void add_search_page_data(const std::filesystem::path& folder, sim::Json& page);

}  // namespace tools::pages
