#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace tools {

inline constexpr std::uint64_t kLargestReport = 1ULL << 30;

/// File name of the reference's report, next to that of the run.
inline constexpr const char* kReferenceReport = "reference.json";

/// A parsed report.json.
struct ReportFile {
  std::filesystem::path file;
  sim::Json json;
  std::map<std::string, double> numbers;  ///< all numbers of the report by path, from report_numbers()

  /// Returns the number at a path; 0 if the report lacks it.
  double number(const std::string& path) const;
  bool has(const std::string& path) const { return numbers.contains(path); }
  /// Returns a text value of the report by group and key, e.g. "provenance", "model_id"; empty if absent.
  std::string text(const std::string& group, const std::string& key) const;
  /// True for the report of a reference program; the tables of tiles and pixels in its folder belong to the run itself.
  bool is_reference() const { return file.filename() == kReferenceReport; }
  /// Returns the path of the rendered picture, which is next to the report. `type`: "png" or "exr".
  std::filesystem::path picture(const char* type) const;
};

/// Reads the report of a run from a file or folder. Throws InputError if there is none, it is not JSON, or its schema
/// is not raywatt-report/1.
ReportFile load_report(const std::filesystem::path& file_or_folder);
/// Parses the bytes of a report. `file`: its path, for errors. Throws InputError like load_report().
ReportFile parse_report(const std::string& bytes, const std::filesystem::path& file);

/// The configuration in a report.json: value by full key, e.g. "tni.trv.l1.size" -> "16 KiB".
using FlatConfig = std::map<std::string, std::string>;
FlatConfig flat_config(const sim::Json& config);

/// A number of a report and its path: "totals.rays.shadow", "frames[2].cycles", "units.core0.tni.trv2.why.l1_miss".
struct ReportNumber {
  std::string path;
  double value = 0;
};

/// Returns all numbers of a report, in the order of the file, followed by unit_sums(). Leaves out `host` and
/// `provenance`, which differ between equal runs, and the confidence intervals of counters. Throws InputError for
/// excessive nesting.
std::vector<ReportNumber> report_numbers(const sim::Json& report);

/// PSNR in dB that is assumed for a picture identical to its reference, for which a report has null. Such a picture
/// thus satisfies conditions such as psnr_db>=36.
inline constexpr double kIdenticalPsnr = 100;
/// Names in `totals` of all values of PSNR.
inline constexpr std::array<const char*, 3> kPsnrNames = {"psnr_db", "worst_psnr_db", "temporal_psnr_db"};
/// Sets each PSNR that is null in `report.json` to kIdenticalPsnr in `report.numbers`. In a run of one frame, also sets
/// worst_psnr_db to that frame's PSNR.
void rank_identical_pictures(ReportFile& report);

/// Returns sums over all units of a kind: "units.core.tni.trv.counters.l1_hits" is the sum over all traversal units,
/// "units.core.tni.trv.units" their number. Units without siblings are included.
std::vector<ReportNumber> unit_sums(const sim::Json& report);

/// True for a report path in `totals`.
bool is_totals_path(std::string_view path);
/// Returns a report path without a leading "totals.", as users may type it.
std::string metric_name(std::string_view path);

/// Returns the report path that `text` denotes: `text` itself, "totals." plus `text`, or the only path that ends in
/// `text` after a dot. Paths in `totals` take precedence over all others, except that those of totals.at_fps, which
/// repeat metrics at another rate, come after the rest. Paths in `frames` come last. A group that is a band, such as
/// "power_w", denotes its nominal value. Throws InputError with suggestions if `text` is ambiguous, a group or unknown.
std::string resolve_report_path(std::string_view text, std::span<const std::string> paths);

/// Returns all report paths that `text` denotes: one path, or all paths of a group; "units" denotes the sums of
/// unit_sums(). Returns none if nothing matches; throws InputError if `text` is ambiguous.
std::vector<std::string> report_path_group(std::string_view text, std::span<const std::string> paths);

/// True if `text` denotes a report path, several, or a group of them.
bool denotes_report_path(std::string_view text, std::span<const std::string> paths);

}  // namespace tools
