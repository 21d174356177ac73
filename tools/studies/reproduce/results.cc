#include "tools/studies/reproduce/results.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "sim/sha256.h"
#include "tools/host/paths.h"

namespace tools::reproduce {
namespace {

constexpr std::uint64_t kMostPublishedBytes = 1 << 20;

using Entry = sim::YamlNode::Entry;
using Kind = sim::YamlNode::Kind;

/// Reads the nested mappings of a file of published values.
class PublishedReader {
 public:
  explicit PublishedReader(const std::string& name) : name_(name) {}

  Published read(const sim::YamlNode& root) {
    for (const Entry& experiment : root.entries) {
      for (const Entry& scene : entries_of(experiment, "scenes")) {
        for (const Entry& setting : entries_of(scene, "settings")) {
          for (const Entry& metric : entries_of(setting, "figures")) {
            out_.emplace(MetricKey{experiment.key, scene.key, setting.key, metric.key}, read_range(metric));
          }
        }
      }
    }
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const Entry& at, std::string_view what) const {
    throw sim::InputError(
        fmt::format("{}:{}:{}: '{}' {}", name_, at.key_at.line, at.key_at.column, sim::printable(at.key), what));
  }

  const std::vector<Entry>& entries_of(const Entry& entry, std::string_view of) const {
    if (entry.value->kind != Kind::kMapping) refuse(entry, fmt::format("must be a mapping of {}", of));
    return entry.value->entries;
  }

  double read_number(const Entry& entry) const {
    const std::string& text = entry.value->scalar;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (entry.value->kind != Kind::kScalar || error != std::errc{} || end != text.data() + text.size() ||
        !std::isfinite(value)) {
      refuse(entry, "must be a number");
    }
    return value;
  }

  Range read_range(const Entry& entry) const {
    if (entry.value->kind == Kind::kScalar) return {read_number(entry), read_number(entry)};
    const std::vector<Entry>& ends = entries_of(entry, "low and high, or a number");
    const Entry* low = entry.value->find("low");
    const Entry* high = entry.value->find("high");
    if (low == nullptr || high == nullptr || ends.size() != 2 || read_number(*low) > read_number(*high)) {
      refuse(entry, "must be a number, or {low: number, high: a greater number}");
    }
    return {read_number(*low), read_number(*high)};
  }

  const std::string& name_;
  Published out_;
};

}  // namespace

Published parse_published(const std::string& text, const std::string& name) {
  return PublishedReader(name).read(*sim::parse_yaml_mapping(text, name));
}

Published load_published(const std::string& paper) {
  const std::string name = paper + ".yaml";
  for (const std::filesystem::path& folder : search_folders()) {
    for (const std::filesystem::path& file :
         {folder / "tests" / "validation" / "published" / name, folder / "published" / name}) {
      std::error_code missing;
      if (std::filesystem::exists(file, missing))
        return parse_published(sim::read_file(file, kMostPublishedBytes), file);
    }
  }
  throw sim::InputError(
      fmt::format("the published figures of {} are neither in the source tree nor installed; "
                  "$RAYWATT_PATH may name a folder that has published/{}",
                  paper, name));
}

namespace {

std::string measured_text(const Row& row) {
  if (!row.measured) return row.why_not;
  return metric_text(find_metric(row.key.metric), *row.measured);
}

std::string published_text(const Row& row) {
  if (!row.published) return "";
  const Metric& metric = find_metric(row.key.metric);
  const std::string low = metric_text(metric, row.published->low);
  return row.published->low == row.published->high ? low : low + " to " + metric_text(metric, row.published->high);
}

/// Returns the difference to the published value, in dB or percent.
std::string difference_text(const Row& row) {
  if (!row.measured || !row.published) return "";
  const double value = *row.measured;
  const double nearest = std::clamp(value, row.published->low, row.published->high);
  if (row.published->low != row.published->high && value == nearest) return "within";
  if (find_metric(row.key.metric).shown == Metric::Shown::kDecibel) return fmt::format("{:+.1f} dB", value - nearest);
  return fmt::format("{:+.0f} %", 100 * (value / nearest - 1));
}

std::string size_text(const Row& row) { return fmt::format("{}x{}", row.width, row.height); }

std::string heading_text(const Results& results) {
  std::string out = results.title;
  if (results.quick) out += ", quick: few pixels, so the values only show that it runs";
  if (results.shrink > 1) out += fmt::format(", sides of pictures divided by {}", results.shrink);
  if (results.partial) out += "; PARTIAL: some settings have not run";
  return out;
}

}  // namespace

std::vector<Row> by_experiment(std::vector<Row> rows) {
  std::vector<std::string> order;
  for (const Row& row : rows) {
    if (std::ranges::find(order, row.key.experiment) == order.end()) order.push_back(row.key.experiment);
  }
  std::ranges::stable_sort(rows, {}, [&](const Row& r) { return std::ranges::find(order, r.key.experiment); });
  return rows;
}

sim::Json rows_json(const Results& results) {
  sim::Json out = sim::Json::array();
  for (const Row& row : results.rows) {
    sim::Json entry = {{"experiment", row.key.experiment},
                       {"scene", row.key.scene},
                       {"stand_in", sim::printable(row.stand_in, 4096)},
                       {"resolution", {row.width, row.height}},
                       {"setting", row.key.setting},
                       {"program", row.program},
                       {"reference", row.reference},
                       {"figure", row.key.metric}};
    entry["measured"] = row.measured ? sim::Json(*row.measured) : sim::Json(nullptr);
    if (!row.measured) entry["why_not"] = sim::printable(row.why_not, 4096);
    if (row.published && row.published->low == row.published->high) {
      entry["published"] = row.published->low;
    } else if (row.published) {
      entry["published"] = {row.published->low, row.published->high};
    } else {
      entry["published"] = nullptr;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

std::string results_text(const Results& results) {
  sim::Table table({"experiment", "scene", "setting", "figure", "measured", "published", "difference"});
  for (const Row& row : by_experiment(results.rows)) {
    table.add_row({row.key.experiment, row.key.scene, row.key.setting, row.key.metric,
                   row.measured ? measured_text(row) : "-", published_text(row), difference_text(row)});
  }
  std::string out = heading_text(results) + "\n\n" + table.text();
  std::string before;
  for (const Row& row : results.rows) {
    const std::string line = fmt::format("{}, {}: {}\n", row.key.scene, row.key.setting, row.why_not);
    if (row.measured || line == before) continue;
    out += (before.empty() ? "\nnot measured\n" : "") + line;
    before = line;
  }
  if (!results.note.empty()) out += fmt::format("\n{}\n", results.note);
  return out;
}

namespace {

/// Returns a table of programs and references by setting.
std::string programs_markdown(std::span<const Row> rows) {
  std::string out = "\n| setting | run | compared with |\n|---|---|---|\n";
  std::vector<std::string> listed;
  for (const Row& row : rows) {
    std::string line = fmt::format("| {} | `{}` | `{}` |\n", row.key.setting, row.program, row.reference);
    if (std::ranges::find(listed, line) != listed.end()) continue;
    out += line;
    listed.push_back(std::move(line));
  }
  return out;
}

/// Returns a table of the median and range of each metric over the scenes.
std::string scenes_markdown(std::span<const Row> rows) {
  std::string out;
  std::vector<std::pair<std::string, std::string>> listed;
  for (const Row& row : rows) {
    const std::pair metric{row.key.setting, row.key.metric};
    if (std::ranges::find(listed, metric) != listed.end()) continue;
    listed.push_back(metric);
    std::vector<double> values;
    for (const Row& other : rows) {
      const bool same = other.key.setting == metric.first && other.key.metric == metric.second;
      if (same && other.measured) values.push_back(*other.measured);
    }
    if (values.size() < 2) continue;
    std::ranges::sort(values);
    const double median = (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
    const auto text = [&](double value) { return metric_text(find_metric(metric.second), value); };
    out += fmt::format("| {} | {} | {} | {} | {} to {} | {} |\n", metric.first, metric.second, values.size(),
                       text(median), text(values.front()), text(values.back()), published_text(row));
  }
  if (out.empty()) return out;
  return "\n| setting | figure | scenes | median | range | published |\n|---|---|---|---|---|---|\n" + out;
}

std::string experiment_markdown(std::span<const Row> rows) {
  std::string out = fmt::format("\n## {}\n", rows.front().key.experiment);
  out += programs_markdown(rows) + scenes_markdown(rows);
  out +=
      "\n| scene | stand-in | pixels | setting | figure | measured | published | difference |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const std::string stand_in = std::filesystem::path(row.stand_in).filename().string();
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.key.scene, stand_in, size_text(row),
                       row.key.setting, row.key.metric, measured_text(row), published_text(row), difference_text(row));
  }
  return out;
}

}  // namespace

std::string results_markdown(const Results& results, const std::vector<std::string>& pictures) {
  std::string out = fmt::format("# {}\n", heading_text(results));
  if (!results.note.empty()) out += fmt::format("\n{}\n", results.note);
  const std::vector<Row> rows = by_experiment(results.rows);
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last =
        std::find_if(first, rows.end(), [&](const Row& row) { return row.key.experiment != first->key.experiment; });
    out += experiment_markdown({first, last});
    first = last;
  }
  if (!pictures.empty()) out += "\n## Pictures\n";
  for (const std::string& picture : pictures) out += fmt::format("\n{}\n\n![{}]({})\n", picture, picture, picture);
  return out;
}

namespace fs = std::filesystem;

namespace {

using sim::Json;

constexpr std::uint64_t kMostResultBytes = 64 << 20;  ///< typical: 200 KB
constexpr std::uint64_t kMostOfScene = 8ULL << 30;

/// True if everything that rows depend on is equal, except their own cases.
bool is_same_run(const Json& former, const Json& head) {
  for (const auto& [key, value] : head.items()) {
    if (key == "partial" || key == "provenance") continue;
    if (!former.contains(key) || former[key] != value) return false;
  }
  for (const auto& [key, value] : head.at("provenance").items()) {
    if (key != "argv" && former.at("provenance").at(key) != value) return false;
  }
  return former.at("partial").get<bool>();
}

Row row_of(const Json& entry) {
  const auto text = [&](const char* key) { return entry.at(key).get<std::string>(); };
  Row row{.key = {text("experiment"), text("scene"), text("setting"), text("figure")},
          .stand_in = text("stand_in"),
          .width = entry.at("resolution").at(0).get<std::uint32_t>(),
          .height = entry.at("resolution").at(1).get<std::uint32_t>(),
          .program = text("program"),
          .reference = text("reference"),
          .measured = {},
          .why_not = entry.value("why_not", ""),
          .published = {}};
  if (entry.at("measured").is_number()) row.measured = entry.at("measured").get<double>();
  return row;
}

Former read_former(const Json& former, const Json& head) {
  Former out{.rows = former.at("rows").size(), .finished = {}};
  if (!is_same_run(former, head)) return out;
  const Json& digests = former.at("scenes");
  std::map<std::string, bool> unchanged;
  for (const Json& entry : former.at("rows")) {
    Row row = row_of(entry);
    const auto [at, is_new] = unchanged.try_emplace(row.stand_in, false);
    if (is_new) at->second = digests.value(row.stand_in, "") == digest_of_file(row.stand_in);
    if (at->second) out.finished.push_back(std::move(row));
  }
  return out;
}

}  // namespace

std::string digest_of_file(const fs::path& scene) {
  std::error_code unreadable;
  if (!fs::is_regular_file(scene, unreadable)) return {};
  return sim::sha256_hex(sim::read_file(scene, kMostOfScene));
}

Former load_former(const fs::path& folder, const Json& head) {
  try {
    return read_former(sim::parse_json(sim::read_file(folder / "reproduce.json", kMostResultBytes)), head);
  } catch (const sim::InputError&) {
  } catch (const sim::JsonError&) {
  }
  return {};
}

}  // namespace tools::reproduce
