#pragma once
#include <vector>

#include "sim/io/json.h"
#include "tools/analysis/report_file.h"

namespace tools::pages {

/// Returns what the page of several runs shows, each run but the first compared with the first.
///   names, titles   of all runs
///   against         entries of comparison_json() (schema raywatt-compare/1)
///   warnings        a list per entry
///   pictures        per entry the block of both pictures and of differences by tile; `missing`: why pictures are
///   missing
sim::Json diff_data(const std::vector<ReportFile>& reports);

}  // namespace tools::pages
