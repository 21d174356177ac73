#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "tools/studies/sweep/results/index/report_scan.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::results {

/// The fate of a point.
enum class Status { kDone, kFailed, kMissing, kDamaged };
std::string_view name_of(Status status);

/// Numbers of points of a sweep, by the name of their fate.
using StatusCounts = std::map<std::string, std::size_t, std::less<>>;
/// "2 of 200 points have no result: 1 failed, 1 missing", or nothing.
std::string missing_text(const StatusCounts& counts);

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

/// The fate of a point whose report the store does not give.
Status status_without_report(const sweep::Store& store, const std::string& id);

/// Sizes and times of a point's files in the store, which change whenever these do.
std::string state_mark(const sweep::Store& store, const std::string& id);
/// The same of one file; "-" if there is none.
std::string file_mark(const std::filesystem::path& file);

}  // namespace tools::results
