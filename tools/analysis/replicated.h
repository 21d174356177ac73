#pragma once
#include <optional>
#include <string>

#include "sim/io/json.h"
#include "tools/analysis/report.h"
#include "tools/analysis/report_file.h"
#include "tools/noise/statistics.h"

namespace tools {

/// `totals.replicates` of a report: statistics of these figures over all plays, the first of which is `plain`.
sim::Json replicates_json(const Result& result, const sim::Json& plain);

/// The same in a line, and of the figures that people look at first as a table.
std::string replicates_text(const sim::Json& replicates);
std::string replicates_table(const sim::Json& replicates);

/// Draws of a figure, e.g. "energy_mj.nominal", that a report has; none without replicates.
std::optional<Draws> draws_in(const ReportFile& report, const std::string& figure);

/// Difference of a figure of two reports, and what noise makes of it.
struct NoisyDifference {
  double relative = 0;    ///< b's mean, or figure, over a's, less 1
  double half_width = 0;  ///< half of its 95 % interval, as a part of a's
  bool measured = false;  ///< by replicates of both
  bool outside = false;   ///< beyond what noise explains
};
/// None for figures that have no noise, or are 0.
std::optional<NoisyDifference> noisy_difference(const ReportFile& a, const ReportFile& b, const std::string& figure);

}  // namespace tools
