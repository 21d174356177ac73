#include "tools/analysis/report_file.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "traces/scene/did_you_mean.h"

namespace tools {

using sim::Json;

namespace {

/// Returns a description of the `schema` member of a JSON value, for error messages.
std::string schema_of(const Json& json) {
  if (!json.is_object() || !json.contains("schema")) return "no 'schema'";
  const Json& schema = json["schema"];
  return schema.is_string() ? fmt::format("schema '{}'", sim::printable(schema.get<std::string>())) : "a broken schema";
}

constexpr int kDeepest = 32;

/// Adds all values of a configuration below `node` to `out`, by full key. A band (low, nominal, high) is one value.
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
  if (is_folder && !std::filesystem::exists(file, ignored) && !ignored) {
    throw sim::InputError(
        fmt::format("{}: has no report.json, so it is no run; allowed: a folder that 'raywatt run' wrote",
                    sim::printable(file_or_folder.string())));
  }
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
  } catch (const sim::InputError& error) {  // the message already states what is allowed
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

namespace {

using Numbers = std::vector<ReportNumber>;

constexpr int kDeepestReport = 32;

void collect_numbers(const Json& node, const std::string& path, int depth, Numbers& out) {
  if (depth > kDeepestReport) throw sim::InputError("the report is nested more deeply than any report");
  if (node.is_number()) {
    out.push_back({path, node.get<double>()});
  } else if (node.is_object()) {
    for (const auto& [key, value] : node.items())
      collect_numbers(value, fmt::format("{}.{}", path, key), depth + 1, out);
  } else if (node.is_array()) {
    for (std::size_t i = 0; i < node.size(); ++i)
      collect_numbers(node[i], fmt::format("{}[{}]", path, i), depth + 1, out);
  }
}

/// Returns the kind of a unit: the name without its number, if sibling units are numbered from 0 ("core3" -> "core").
std::string kind_of(const std::string& name, const Json& siblings) {
  const std::string kind = name.substr(0, name.find_last_not_of("0123456789") + 1);
  return !kind.empty() && siblings.contains(kind + "0") ? kind : name;
}

/// Sums the numbers of all units of the same kind in the tree `units` of a report.
class Sums {
 public:
  void add(const Json& node, const std::string& kind, int depth) {
    if (depth > kDeepestReport) return;
    for (const auto& [key, value] : node.items()) {
      if (value.is_object()) add(value, fmt::format("{}.{}", kind, kind_of(key, node)), depth + 1);
      if (value.is_number()) add(fmt::format("{}.{}", kind, key), value.get<double>());
    }
    if (node.contains("elapsed")) add(kind + ".units", 1);
  }
  Numbers take_sums() { return std::move(numbers_); }

 private:
  void add(std::string path, double value) {
    const auto [at, is_new] = indices_.emplace(path, numbers_.size());
    if (is_new) numbers_.push_back({std::move(path), 0});
    numbers_[at->second].value += value;
  }
  Numbers numbers_;
  std::map<std::string, std::size_t> indices_;
};

bool ends_in(std::string_view path, std::string_view text) {
  return path.ends_with(text) && path.size() > text.size() && path[path.size() - text.size() - 1] == '.';
}

/// True if a report path belongs to the group `text`, as "totals.rays.shadow" belongs to "totals.rays".
bool is_in_path_group(std::string_view path, std::string_view text) {
  return path.size() > text.size() && path.starts_with(text) && (path[text.size()] == '.' || path[text.size()] == '[');
}

/// Returns the end of a report path with as many components as `text` has.
std::string path_end_of_same_depth(std::string_view path, std::string_view text) {
  std::size_t at = std::string_view::npos;
  for (auto dots = std::ranges::count(text, '.'); dots >= 0; --dots) {
    at = at == 0 ? std::string_view::npos : path.rfind('.', at == std::string_view::npos ? at : at - 1);
    if (at == std::string_view::npos) return std::string(path);
  }
  return std::string(path.substr(at + 1));
}

constexpr std::size_t kMostShown = 8;

[[noreturn]] void refuse_several(std::string_view text, const char* what, const std::vector<std::string>& candidates,
                                 const std::string& hint = "") {
  const std::size_t shown = std::min(candidates.size(), kMostShown);
  throw sim::InputError(
      fmt::format("the report path '{}' {}: {}{}{}", sim::printable(text), what,
                  fmt::join(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                  shown < candidates.size() ? fmt::format(" and {} more", candidates.size() - shown) : "", hint));
}

/// Returns the rank of a report path among those that end in the same text, 0 for the first.
std::size_t rank_of(std::string_view path) {
  if (path.starts_with("frames[")) return 3;
  if (!path.starts_with("totals.")) return 2;
  return path.starts_with("totals.at_fps.") ? 1 : 0;  // at_fps.fps is the target, perf.fps the metric
}

/// The report paths that a text typed by the user can denote: one path, a group, several ambiguous paths, or none.
struct PathCandidates {
  PathCandidates(std::string_view text, std::span<const std::string> paths) {
    if (text.empty()) return;
    const std::string in_totals = fmt::format("totals.{}", text), inside = fmt::format(".{}.", text);
    std::array<std::vector<std::string>, 4> ends;  // matching paths by rank
    std::vector<std::string> below;
    for (const std::string& path : paths) {
      if (path == text || (path == in_totals && one.empty())) one = path;
      if (is_in_path_group(path, text) || is_in_path_group(path, in_totals)) group.push_back(path);
      if (path.find(inside) != std::string::npos) below.push_back(path);
      if (ends_in(path, text)) ends[rank_of(path)].push_back(path);
    }
    if (!one.empty() || !group.empty()) return;
    const auto first = std::ranges::find_if(ends, [](const auto& candidates) { return !candidates.empty(); });
    if (first == ends.end()) {
      group = below;
    } else if (first->size() == 1) {
      one = first->front();
    } else {
      several = *first;
    }
  }
  std::string one;
  std::vector<std::string> group, several;
};

/// Returns ", did you mean 'x'?" for a mistyped report path, or an empty text. Suggests the end of a path that starts
/// with `start`. The path of a whole band (low, nominal, high) may also be suggested.
std::string nearest_end(std::string_view text, std::span<const std::string> paths, std::string_view start) {
  constexpr std::string_view kNominal = ".nominal";
  std::set<std::string> known;
  for (const std::string_view path : paths) {
    if (!path.starts_with(start)) continue;
    known.insert(path_end_of_same_depth(path, text));
    if (path.ends_with(kNominal))
      known.insert(path_end_of_same_depth(path.substr(0, path.size() - kNominal.size()), text));
  }
  const std::vector<std::string> names(known.begin(), known.end());
  return traces::did_you_mean(text, names);
}

/// A number or group of `totals` that a report has only if a key is set.
struct ConditionalNumber {
  std::string_view name, condition;
};
constexpr std::string_view kNeedsReference = "reference (--reference of a run)",
                           kNeedsSequence = "reference (--reference of a run) and several frames",
                           kNeedsRate = "frame.fps (--fps)", kNeedsMinutes = "thermal.minutes";
constexpr auto kConditionalNumbers = std::to_array<ConditionalNumber>({{"psnr_db", kNeedsReference},
                                                                       {"worst_psnr_db", kNeedsReference},
                                                                       {"temporal_psnr_db", kNeedsSequence},
                                                                       {"relative", kNeedsReference},
                                                                       {"fps_margin", kNeedsRate},
                                                                       {"power_at_fps_w", kNeedsRate},
                                                                       {"at_fps", kNeedsRate},
                                                                       {"sustained_fps", kNeedsMinutes},
                                                                       {"stability", kNeedsMinutes},
                                                                       {"sustained", kNeedsMinutes}});

/// Returns " without the key K" for a report path that needs this key, else an empty text.
std::string missing_key_text(std::string_view text) {
  const std::string name = metric_name(text);
  const auto* const found =
      std::ranges::find(kConditionalNumbers, name.substr(0, name.find('.')), &ConditionalNumber::name);
  return found == kConditionalNumbers.end() ? "" : fmt::format(" without the key {}", found->condition);
}

/// Returns the path of the nominal value if the paths of a group are a band (low, nominal, high); otherwise empty.
std::string nominal_value_path(const std::vector<std::string>& group) {
  constexpr std::size_t kSides = 3;
  if (group.size() != kSides) return {};
  const std::string name = group.front().substr(0, group.front().rfind('.'));
  for (const char* side : {".low", ".nominal", ".high"}) {
    if (std::ranges::find(group, name + side) == group.end()) return {};
  }
  return name + ".nominal";
}

}  // namespace

bool is_totals_path(std::string_view path) { return path.starts_with("totals."); }

std::string metric_name(std::string_view path) {
  return std::string(is_totals_path(path) ? path.substr(std::string_view("totals.").size()) : path);
}

void rank_identical_pictures(ReportFile& report) {
  for (const std::string name : kPsnrNames) {
    const sim::JsonPointer psnr("/totals/" + name);
    if (report.json.contains(psnr) && report.json.at(psnr).is_null()) report.numbers["totals." + name] = kIdenticalPsnr;
  }
  if (report.has("totals.psnr_db")) report.numbers.emplace("totals.worst_psnr_db", report.number("totals.psnr_db"));
}

Numbers report_numbers(const Json& report) {
  Numbers out;
  if (!report.is_object()) return out;
  for (const auto& [key, value] : report.items()) {
    const bool has_no_metrics = key == "host" || key == "provenance" || key == "sampled_counters" || key == "sequence";
    if (!has_no_metrics) collect_numbers(value, key, 1, out);
  }
  Numbers sums = unit_sums(report);
  {
    std::set<std::string_view> known;
    for (const ReportNumber& number : out) known.insert(number.path);
    std::erase_if(sums, [&](const ReportNumber& sum) { return known.contains(sum.path); });
  }
  std::ranges::move(sums, std::back_inserter(out));
  return out;
}

Numbers unit_sums(const Json& report) {
  Sums sums;
  if (!report.is_object()) return {};
  if (const auto units = report.find("units"); units != report.end() && units->is_object()) {
    sums.add(*units, "units", 0);
  }
  return sums.take_sums();
}

std::string resolve_report_path(std::string_view text, std::span<const std::string> paths) {
  const PathCandidates m(text, paths);
  if (!m.one.empty()) return m.one;
  if (std::string nominal = nominal_value_path(m.group); !nominal.empty()) return nominal;
  if (!m.group.empty()) {
    const bool is_in_totals = m.group.front().starts_with("totals.");
    const std::string nearest = is_in_totals ? "" : nearest_end(text, paths, "totals.");
    if (!nearest.empty() && m.group.size() > kMostShown) {
      throw sim::InputError(fmt::format("the report path '{}' is a group of {} numbers, none of them a figure{}",
                                        sim::printable(text), m.group.size(), nearest));
    }
    refuse_several(text, "is a group of", m.group, nearest);
  }
  if (!m.several.empty()) refuse_several(text, "may mean any of", m.several);
  const std::string missing = missing_key_text(text);
  throw sim::InputError(
      fmt::format("there is no report path '{}'{}; allowed is what report.json has, or the end of it, e.g. cycles, "
                  "perf.frames_per_joule_gpu",
                  sim::printable(text), missing.empty() ? nearest_end(text, paths, "") : missing));
}

std::vector<std::string> report_path_group(std::string_view text, std::span<const std::string> paths) {
  PathCandidates m(text, paths);
  if (!m.one.empty()) return {m.one};
  if (!m.several.empty()) refuse_several(text, "may mean any of", m.several);
  if (text != "units") return m.group;
  // Only the path of a sum over units has a `units` entry; paths without one belong to a single unit.
  const std::set<std::string> known(paths.begin(), paths.end());
  std::erase_if(m.group, [&](const std::string& path) {
    const std::size_t end = std::min(path.find(".why."), path.find(".counters."));
    const std::string unit = path.substr(0, end == std::string::npos ? path.rfind('.') : end);
    return !known.contains(unit + ".units");
  });
  return m.group;
}

bool denotes_report_path(std::string_view text, std::span<const std::string> paths) {
  const PathCandidates m(text, paths);
  return !m.one.empty() || !m.several.empty() || !m.group.empty();
}

}  // namespace tools
