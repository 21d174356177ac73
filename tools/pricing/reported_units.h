#pragma once
#include <string>
#include <vector>

#include "sim/unit_report.h"
#include "tools/analysis/report_file.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"

namespace tools {

/// Returns the configuration of a report. Throws InputError if it has none, or one that this program does not support.
RunConfig reported_config(const ReportFile& report);

/// Counts of all units in a report. They can be copied into the units of a machine that has not run.
class ReportedCounts {
 public:
  /// Throws InputError if the report has no counts.
  explicit ReportedCounts(const ReportFile& report);
  /// Writes the report's counts into `units`, which are units of a machine that has not run. Throws InputError if the
  /// counts do not match the units.
  void fill(std::vector<sim::UnitReport>& units) const;
  /// Returns which optional units the machine of the report has.
  OptionalUnits optional_units() const;
  /// Throws InputError with the reason `why`: another model made the report.
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  std::uint64_t number(const sim::Json& node, const char* group, const std::string& name,
                       const sim::UnitReport& unit) const;

  const ReportFile& report_;
  const sim::Json* units_ = nullptr;
};

}  // namespace tools
