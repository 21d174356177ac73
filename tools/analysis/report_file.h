#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "sim/io/json.h"

namespace tools {

inline constexpr std::uint64_t kLargestReport = 1ULL << 30;

/// The report of what a run was compared with, beside the run's own.
inline constexpr const char* kReferenceReport = "reference.json";

/// A report.json that somebody has handed in.
struct ReportFile {
  std::filesystem::path file;
  sim::Json json;
  std::map<std::string, double> numbers;  ///< report_numbers() by path

  /// 0 where the report has none.
  double number(const std::string& path) const;
  bool has(const std::string& path) const { return numbers.contains(path); }
  /// The text at two keys, e.g. "provenance", "model_id"; empty where the report has none.
  std::string text(const std::string& group, const std::string& key) const;
  /// It is that of what a run was compared with: tables of tiles and pixels in its folder are the run's.
  bool is_reference() const { return file.filename() == kReferenceReport; }
  /// The picture beside it, which is named after it where it is that of a reference. `type`: "png" or "exr".
  std::filesystem::path picture(const char* type) const;
};

/// Reads the report of a run: the file itself, or the folder of a run. InputError if there is none, if it is not JSON,
/// or if its schema is another than raywatt-report/1.
ReportFile load_report(const std::filesystem::path& file_or_folder);
/// The same of the bytes of a file that has been read.
ReportFile parse_report(const std::string& bytes, const std::filesystem::path& file);

/// A configuration, as report.json has it, key by key: "tni.trv.l1.size" -> "16 KiB".
using FlatConfig = std::map<std::string, std::string>;
FlatConfig flat_config(const sim::Json& config);

}  // namespace tools
