#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/analysis/report_file.h"

namespace tools::pages {

/// "chess, 1024x512, full:1"
std::string run_title(const ReportFile& report);

/// Returns what the page of a run shows: its report, and what the page's script cannot derive from it.
///   title, command; report (of `frames` only what the page lists)
///   unit_kinds   [{name, reasons: [{name, kind, meaning}]}]
///   resources    words by name, e.g. {"l1": "first-level caches"}
///   kernels      {name: {meaning, bound}}; bound: what limits the initiation interval
///   flow         [[from, to, low, nominal, high], ...] in mJ; null, with the reason in not_priced
///   series       {begin_us, end_us, all: [{group, name, unit, values}]}, or a note
///   picture      run_picture()
sim::Json run_data(const ReportFile& report);

/// Returns the picture block of a run with its overlays and debug pictures, or {missing: reason}.
sim::Json run_picture(const ReportFile& report);

/// Returns what the page of several runs shows, each run but the first compared with the first.
///   names, titles   of all runs
///   against         entries of comparison_json() (schema raywatt-compare/1)
///   warnings        a list per entry
///   pictures        per entry the block of both pictures and of differences by tile; `missing`: why there are none
sim::Json diff_data(const std::vector<ReportFile>& reports);

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
