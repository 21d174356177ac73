#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace tools {

/// A number of a report and where it stands: "totals.rays.shadow", "frames[2].cycles",
/// "units.core0.tni.trv2.why.l1_miss".
struct ReportNumber {
  std::string path;
  double value = 0;
};

/// Every number of a report in its order, but those of `host` and `provenance`, which differ between equal runs, and
/// intervals of counters; behind them unit_sums(). InputError for what is nested more deeply than any report.
std::vector<ReportNumber> report_numbers(const sim::Json& report);

/// A path without the numbers of its units is their sum: "units.core.tni.trv.counters.l1_hits" is that of all traversal
/// units, "units.core.tni.trv.units" says how many there are. Units that are alone are told as well.
std::vector<ReportNumber> unit_sums(const sim::Json& report);

/// Is this a path of `totals`?
bool is_total(std::string_view path);
/// A path as people read it everywhere, and may type it: without "totals." in front.
std::string figure_name(std::string_view path);

/// The one of `paths` that `text` means: itself, or "totals." before it, or else the one that ends in it at a dot.
/// Paths of totals win over those of units and all else, and these over those of single frames. A figure with a band
/// means its nominal one: "power_w".
/// InputError with the candidates if that leaves several or `text` is a group, and with the nearest if it leaves none.
std::string resolve_report_path(std::string_view text, std::span<const std::string> paths);

/// All that `text` means: the one path, or if it is a group all in it; "units" stands for unit_sums(). Nothing if there
/// is no such path; InputError if it may mean several that are no group.
std::vector<std::string> report_path_group(std::string_view text, std::span<const std::string> paths);

}  // namespace tools
