#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace tools {

/// A number of a report and its path: "totals.rays.shadow", "frames[2].cycles", "units.core0.tni.trv2.why.l1_miss".
struct ReportNumber {
  std::string path;
  double value = 0;
};

/// Returns the numbers of a report in order, then unit_sums(). Leaves out `host` and `provenance`, which differ between
/// equal runs, and intervals of counters. InputError for excessive nesting.
std::vector<ReportNumber> report_numbers(const sim::Json& report);

/// Returns sums over similar units: "units.core.tni.trv.counters.l1_hits" is the sum over all TRVs,
/// "units.core.tni.trv.units" their number. Single units are included.
std::vector<ReportNumber> unit_sums(const sim::Json& report);

/// True for a path in `totals`.
bool is_total(std::string_view path);
/// Returns a path as it is displayed and may be typed: without a leading "totals.".
std::string metric_name(std::string_view path);

/// Returns the path that `text` denotes: itself, "totals." plus itself, or the only path that ends in it at a dot.
/// Totals take precedence over units and others, these over single frames. A group that is a band denotes its nominal
/// value: "power_w". InputError with candidates if ambiguous, if a group, or if nothing matches.
std::string resolve_report_path(std::string_view text, std::span<const std::string> paths);

/// Returns all paths that `text` denotes: one path, or all paths of a group; "units" denotes unit_sums(). Empty if
/// nothing matches; InputError if ambiguous.
std::vector<std::string> report_path_group(std::string_view text, std::span<const std::string> paths);

}  // namespace tools
