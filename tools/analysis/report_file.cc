#include "tools/analysis/report_file.h"

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_paths.h"

namespace tools {

using sim::Json;

namespace {

/// Describes the schema of a JSON value, for errors.
std::string schema_of(const Json& json) {
  if (!json.is_object() || !json.contains("schema")) return "no 'schema'";
  const Json& schema = json["schema"];
  return schema.is_string() ? fmt::format("schema '{}'", sim::printable(schema.get<std::string>())) : "a broken schema";
}

constexpr int kDeepest = 32;

/// Values with a band are not split.
void flatten_config(const Json& node, const std::string& key, int depth, FlatConfig& out) {
  if (node.is_object() && node.size() == 3 && node.contains("nominal")) {
    out[sim::printable(key)] = sim::printable(sim::json_line(node));
  } else if (node.is_object() && depth < kDeepest) {
    for (const auto& [name, value] : node.items()) {
      flatten_config(value, key.empty() ? name : key + "." + name, depth + 1, out);
    }
  } else if (!node.is_structured()) {
    out[sim::printable(key)] = sim::printable(node.is_string() ? node.get<std::string>() : sim::json_line(node));
  }
}

}  // namespace

double ReportFile::number(const std::string& path) const {
  const auto found = numbers.find(path);
  return found == numbers.end() ? 0 : found->second;
}

std::filesystem::path ReportFile::picture(const char* type) const {
  return file.parent_path() / fmt::format("{}.{}", is_reference() ? "reference" : "image", type);
}

std::string ReportFile::text(const std::string& group, const std::string& key) const {
  const auto at = json.find(group);
  if (at == json.end() || !at->is_object()) return {};
  const auto value = at->find(key);
  return value != at->end() && value->is_string() ? value->get<std::string>() : std::string();
}

ReportFile load_report(const std::filesystem::path& file_or_folder) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(file_or_folder, ignored);
  const std::filesystem::path file = is_folder ? file_or_folder / "report.json" : file_or_folder;
  return parse_report(sim::read_file(file, kLargestReport), file);
}

ReportFile parse_report(const std::string& bytes, const std::filesystem::path& file) {
  ReportFile report;
  report.file = file;
  const auto refuse = [&](const std::string& why) {
    return sim::InputError(
        fmt::format("{}: {}; allowed: a folder or report.json that 'raywatt run' wrote, schema "
                    "'raywatt-report/1'",
                    report.file.string(), why));
  };
  try {
    report.json = sim::parse_json(bytes);
  } catch (const sim::JsonError& error) {
    throw refuse(fmt::format("is not JSON: {}", error.what()));
  } catch (const sim::InputError& error) {  // the message already names what is allowed
    throw sim::InputError(fmt::format("{}: {}", report.file.string(), error.what()));
  }
  if (schema_of(report.json) != "schema 'raywatt-report/1'") throw refuse("has " + schema_of(report.json));
  try {
    for (ReportNumber& number : report_numbers(report.json)) {
      report.numbers.emplace(std::move(number.path), number.value);
    }
  } catch (const sim::InputError& error) {
    throw refuse(error.what());
  }
  if (!report.has("totals.cycles")) throw refuse("has no totals.cycles");
  return report;
}

FlatConfig flat_config(const Json& config) {
  FlatConfig out;
  flatten_config(config, "", 0, out);
  return out;
}

}  // namespace tools
