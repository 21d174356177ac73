#pragma once
#include <optional>
#include <string>

#include "sim/io/json.h"
#include "tools/analysis/report.h"
#include "tools/analysis/report_file.h"
#include "tools/noise/statistics.h"

namespace tools {

/// Returns `totals.replicates` of a report: statistics of its noisy totals over all simulations; the first is
/// `plain`.
sim::Json replicates_json(const ComparedResult& result, const sim::Json& plain);

/// Formats the statistics as one line, and as a table of the main metrics.
std::string replicates_text(const sim::Json& replicates);
std::string replicates_table(const sim::Json& replicates);

/// Returns the statistics of a metric such as "energy_mj.nominal" in a report; nullopt without replicates.
std::optional<Draws> draws_in(const ReportFile& report, const std::string& metric);

/// Difference of a metric between two reports, with its noise.
struct NoisyDifference {
  double relative = 0;    ///< relative difference of b's value or mean to a's
  double half_width = 0;  ///< half-width of its 95 % interval, relative to a
  bool measured = false;  ///< true if both have replicates
  bool outside = false;   ///< larger than noise explains
};
/// Returns nullopt for metrics that have no noise or are 0.
std::optional<NoisyDifference> noisy_difference(const ReportFile& a, const ReportFile& b, const std::string& metric);

}  // namespace tools
