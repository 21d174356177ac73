#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "tools/studies/sweep/results/index/report_scan.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::results {

/// The fate of a point.
enum class Status { kDone, kFailed, kMissing, kDamaged };
std::string_view name_of(Status status);

/// The reason that a point has no result.
struct PointError {
  std::string text, log;
  Value exit, host, attempt;
};

struct PointState {
  Status status = Status::kMissing;
  ReportScan report;  ///< if the point is done
  PointError error;   ///< if it failed or is damaged
};

/// Looks a point up in a store. A result wins over the record of an earlier failure. What is not as it was written, or
/// is no finished report, is damaged.
PointState read_point_state(const sweep::Store& store, const std::string& id, MetricNames& names);

/// Sizes and times of a point's files in the store, which change whenever these do.
std::string state_mark(const sweep::Store& store, const std::string& id);
/// The same of one file; "-" if there is none.
std::string file_mark(const std::filesystem::path& file);

}  // namespace tools::results
