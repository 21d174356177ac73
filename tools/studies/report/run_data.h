#pragma once
#include <string>

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

}  // namespace tools::pages
