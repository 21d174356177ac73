#pragma once
#include <filesystem>

#include "sim/io/json.h"

namespace tools::pages {

/// True if the folder is that of a sweep or a search.
bool is_sweep(const std::filesystem::path& folder);

/// Returns what the page of a sweep or a search shows, from the results so far.
///   name, question; goals: texts of a search
///   axes            [{field, levels}], levels in ascending order
///   metrics         [{field, name, show, unit, more}]; more: more is better
///   points          [[n, status, axes..., metrics..., is_eligible, error, command], ...]
///   has_constraints, limits: [[constraint, met, best value, its 95 % interval, room], ...]
///   headlines       fields of the metrics that headlines show, the main one first
///   best            rows of the best points, by metric; ties: words on ties with the best of the main metric
///   start           {x, y, front, near}: metrics and front of the scatter; null without metrics
///   sensitivities   [{metric, points, is_grid, effects: [{axis, share, low, high, range, levels}]}]
///   notices         warnings
sim::Json sweep_data(const std::filesystem::path& folder);

}  // namespace tools::pages
