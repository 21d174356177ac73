#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "sim/io/json.h"

namespace tools {

inline constexpr std::uint64_t kLargestReport = 1ULL << 30;

/// File name of the reference's report, next to that of the run.
inline constexpr const char* kReferenceReport = "reference.json";

/// A parsed report.json.
struct ReportFile {
  std::filesystem::path file;
  sim::Json json;
  std::map<std::string, double> numbers;  ///< report_numbers() by path

  /// Returns 0 if the report lacks the number.
  double number(const std::string& path) const;
  bool has(const std::string& path) const { return numbers.contains(path); }
  /// Returns a text by group and key, e.g. "provenance", "model_id"; empty if absent.
  std::string text(const std::string& group, const std::string& key) const;
  /// True for the report of a reference; the tables of tiles and pixels in its folder belong to the run.
  bool is_reference() const { return file.filename() == kReferenceReport; }
  /// Returns the picture next to the report. `type`: "png" or "exr".
  std::filesystem::path picture(const char* type) const;
};

/// Reads the report of a run from a file or folder. InputError if there is none, it is not JSON, or its schema is not
/// raywatt-report/1.
ReportFile load_report(const std::filesystem::path& file_or_folder);
/// The same for bytes that are already read.
ReportFile parse_report(const std::string& bytes, const std::filesystem::path& file);

/// A configuration from report.json by key: "tni.trv.l1.size" -> "16 KiB".
using FlatConfig = std::map<std::string, std::string>;
FlatConfig flat_config(const sim::Json& config);

}  // namespace tools
