#include "tools/studies/baseline/suite.h"

#include <array>
#include <charconv>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config_tree.h"
#include "sim/config/value.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/run/frame/load_config.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

using Entry = sim::YamlNode::Entry;
using Kind = sim::YamlNode::Kind;

constexpr std::uint64_t kLargestSuite = 1 << 20;

/// A key of a run in a suite file, and the option that it sets.
struct RunKey {
  const char* name;
  std::string JobOptions::*option;
};
constexpr std::array<RunKey, 7> kRunKeys = {{{"config", &JobOptions::config},
                                             {"scene", &JobOptions::scene},
                                             {"camera", &JobOptions::camera},
                                             {"frames", &JobOptions::frames},
                                             {"program", &JobOptions::program},
                                             {"reference", &JobOptions::reference},
                                             {"resolution", &JobOptions::resolution}}};

/// Reader of a YAML file. Its errors name file, line and column.
class YamlFile {
 public:
  explicit YamlFile(const std::filesystem::path& file) : file_(file) {}

 protected:
  std::string location_text(sim::TextPosition position) const {
    return fmt::format("{}:{}:{}", file_.string(), position.line, position.column);
  }
  [[noreturn]] void refuse(sim::TextPosition position, const std::string& key, const std::string& problem) const {
    sim::refuse(location_text(position), key, problem);
  }
  const std::string& text_of(const Entry& entry) const {
    if (entry.value->kind != Kind::kScalar) refuse(entry.value_at, entry.key, "must be a plain value");
    return entry.value->scalar;
  }
  const std::vector<Entry>& entries_of(const Entry& entry) const {
    if (entry.value->kind != Kind::kMapping) refuse(entry.value_at, entry.key, "must be a mapping, 'key: value'");
    return entry.value->entries;
  }
  static std::optional<double> number_in(const std::string& digits) {
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() ? std::optional(value) : std::nullopt;
  }

  const std::filesystem::path& file_;
};

class SuiteReader : YamlFile {
 public:
  using YamlFile::YamlFile;

  Suite read() {
    const auto root = sim::parse_yaml_mapping(sim::read_file(file_, kLargestSuite), file_.string());
    Suite suite;
    suite.file = file_;
    suite.values = std::filesystem::path(file_).replace_extension(".baseline.yaml");
    SuiteRun defaults;
    defaults.options.threads = 1;
    const Entry* runs = nullptr;
    for (const Entry& entry : root->entries) {
      if (entry.key == "values") {
        suite.values = file_.parent_path() / text_of(entry);
      } else if (entry.key == "keep") {
        for (const Entry& kept : entries_of(entry))
          suite.kept.push_back({kept.key, percent_of(kept), location_text(kept.key_at)});
      } else if (entry.key == "defaults") {
        read_run_keys(entry, defaults.options);
      } else if (entry.key == "runs") {
        runs = &entry;
      } else {
        refuse_unknown(entry, {"values", "keep", "defaults", "runs"});
      }
    }
    if (suite.kept.empty())
      sim::refuse(file_.string(), "keep", "is missing or empty; allowed: report paths, e.g. 'cycles: exact'");
    if (runs == nullptr || entries_of(*runs).empty()) {
      sim::refuse(file_.string(), "runs", "is missing or empty; allowed: runs by name, e.g. 'teapot: {scene: teapot}'");
    }
    for (const Entry& entry : entries_of(*runs)) {
      if (entry.key.empty() || sim::printable(entry.key) != entry.key) {
        refuse(entry.key_at, "runs", "the name of a run must be 1 to 160 printable characters");
      }
      SuiteRun run = defaults;
      run.name = entry.key;
      if (entry.value->kind != Kind::kEmpty) read_run_keys(entry, run.options);
      check_run(entry, run);
      suite.runs.push_back(std::move(run));
    }
    return suite;
  }

 private:
  [[noreturn]] void refuse_unknown(const Entry& entry, const std::vector<std::string>& known) const {
    refuse(entry.key_at, entry.key,
           fmt::format("is unknown{}; allowed: {}", traces::did_you_mean(entry.key, known), fmt::join(known, ", ")));
  }
  /// Parses a tolerance, "exact" or "0.5 %", and returns it in percent.
  double percent_of(const Entry& entry) const {
    const std::string& text = text_of(entry);
    if (text == "exact") return 0;
    std::optional<double> percent;
    if (text.ends_with('%')) percent = number_in(text.substr(0, text.find_last_not_of(" %") + 1));
    if (!percent || !(*percent >= 0 && *percent <= 100))
      refuse(entry.value_at, entry.key, "allowed: exact, or a tolerance from 0 % to 100 %, e.g. 0.5 %");
    return *percent;
  }

  /// Returns the path of the named file in the suite's folder, or `name` itself if there is no such file.
  std::string resolve_file(const std::string& name) const {
    const std::filesystem::path file = file_.parent_path() / name;
    std::error_code ignored;
    return !name.empty() && std::filesystem::is_regular_file(file, ignored) ? file.string() : name;
  }

  void read_run_keys(const Entry& run, JobOptions& options) const {
    for (const Entry& entry : entries_of(run)) {
      const auto* key =
          std::ranges::find(kRunKeys, entry.key, [](const RunKey& k) { return std::string_view(k.name); });
      if (key != kRunKeys.end()) {
        const bool may_be_file = entry.key == "config" || entry.key == "scene";
        options.*key->option = may_be_file ? resolve_file(text_of(entry)) : text_of(entry);
      } else if (entry.key == "set") {
        for (const Entry& set : entries_of(entry)) options.sets.push_back(set.key + "=" + text_of(set));
      } else {
        std::vector<std::string> known = {"set"};
        for (const RunKey& k : kRunKeys) known.emplace_back(k.name);
        refuse_unknown(entry, known);
      }
    }
  }

  void check_run(const Entry& entry, const SuiteRun& run) const {
    try {
      load_run_config(run.options);
      kernels::parse_program(run.options.program);
      if (!run.options.reference.empty()) kernels::parse_program(run.options.reference);
    } catch (const sim::InputError& error) {
      refuse(entry.key_at, fmt::format("runs.{}", sim::printable(run.name)), error.what());
    }
  }
};

constexpr std::uint64_t kLargestBaseline = 1ULL << 28;
constexpr const char* kSchema = "raywatt-baseline/1";

class BaselineReader : YamlFile {
 public:
  using YamlFile::YamlFile;

  Baseline read() const {
    const auto root = sim::parse_yaml_mapping(sim::read_file(file_, kLargestBaseline), file_.string());
    const Entry* schema = root->find("schema");
    if (schema == nullptr || schema->value->scalar != kSchema) {
      refuse({}, "schema", fmt::format("must be {}; allowed: what 'raywatt baseline record' writes", kSchema));
    }
    Baseline out;
    FlatConfig common;
    for (const Entry& entry : root->entries) {
      if (entry.key == "embree") out.embree = read_text(entry);
      if (entry.key == "config") common = read_config(entry);
    }
    const Entry* runs = root->find("runs");
    if (runs == nullptr) refuse({}, "runs", "is missing");
    for (const Entry& entry : printable_entries(*runs)) {
      StoredRun& run = out.runs[entry.key] = read_run(entry);
      run.facts.config.insert(common.begin(), common.end());  // does not replace keys that the run has itself
    }
    return out;
  }

 private:
  /// Throws InputError if a text has control characters, because the text will be printed to a terminal.
  void check_printable(const std::string& text, sim::TextPosition position) const {
    if (sim::printable(text, std::string::npos) == text) return;
    refuse(position, {}, "holds text that is not printable; allowed: what 'raywatt baseline record' writes");
  }
  const std::string& read_text(const Entry& entry) const {
    const std::string& text = text_of(entry);
    check_printable(text, entry.value_at);
    return text;
  }
  const std::vector<Entry>& printable_entries(const Entry& entry) const {
    for (const Entry& inner : entries_of(entry)) check_printable(inner.key, inner.key_at);
    return entry.value->entries;
  }
  FlatConfig read_config(const Entry& entry) const {
    FlatConfig out;
    for (const Entry& key : printable_entries(entry)) out[key.key] = read_text(key);
    return out;
  }
  double read_number(const Entry& entry) const {
    const std::optional<double> value = number_in(read_text(entry));
    if (!value) refuse(entry.value_at, entry.key, "must be a number");
    return *value;
  }
  StoredDraws read_draws(const Entry& replicates) const {
    constexpr double kMostPlays = 1e6;
    StoredDraws out;
    for (const Entry& figure : printable_entries(replicates)) {
      Draws& d = out[figure.key];
      for (const Entry& entry : printable_entries(figure)) {
        const double value = read_number(entry);
        if (entry.key == "count" && !(value >= 2 && value <= kMostPlays)) {
          refuse(entry.value_at, entry.key, "must be at least 2 plays");
        }
        if (entry.key == "count") d.count = static_cast<std::size_t>(value);
        if (entry.key == "mean") d.mean = value;
        if (entry.key == "deviation") d.deviation = value;
      }
      if (d.count == 0) refuse(figure.value_at, figure.key, "has no count");
    }
    return out;
  }
  StoredRun read_run(const Entry& run) const {
    StoredRun out;
    for (const Entry& entry : printable_entries(run)) {
      if (entry.key == "program") out.facts.program = read_text(entry);
      if (entry.key == "scene_sha256") out.facts.scene_sha256 = read_text(entry);
      if (entry.key == "bvh_hash") out.facts.bvh_hash = read_text(entry);
      if (entry.key == "config") out.facts.config = read_config(entry);
      if (entry.key == "replicates") out.draws = read_draws(entry);
      if (entry.key != "values") continue;
      for (const Entry& group : printable_entries(entry)) {
        for (const Entry& value : printable_entries(group)) {
          out.values[group.key.empty() ? value.key : group.key + "." + value.key] = read_number(value);
        }
      }
    }
    return out;
  }
};

/// Returns the configuration keys that all runs have, with the most frequent value of each. The file stores these once.
FlatConfig common_config(const Baseline& baseline) {
  std::map<std::string, std::map<std::string, std::size_t>> counts;
  for (const auto& [name, run] : baseline.runs) {
    for (const auto& [key, value] : run.facts.config) counts[key][value] += 1;
  }
  FlatConfig common;
  for (const auto& [key, values] : counts) {
    std::size_t runs = 0;
    auto most = values.begin();
    for (auto value = values.begin(); value != values.end(); ++value) {
      runs += value->second;
      if (value->second > most->second) most = value;
    }
    if (runs == baseline.runs.size()) common[key] = most->first;
  }
  return common;
}

/// Returns a text as a YAML scalar, quoted if YAML would not read it unchanged.
std::string yaml_scalar(const std::string& text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.:/ ";
  const bool plain = !text.empty() && text.find_first_not_of(kPlain) == std::string::npos && text.front() != ' ' &&
                     text.back() != ' ' && text.back() != ':' && text.find(": ") == std::string::npos && text != "null";
  return plain ? text : sim::double_quoted(text);
}

/// Formats values as YAML with one line per group of report paths: "totals.rays: {primary: 2048, shadow: 2340}".
std::string values_text(const Values& values) {
  std::map<std::string, std::vector<std::string>> groups;
  for (const auto& [path, value] : values) {
    const std::size_t dot = path.rfind('.');
    const bool has_dot = dot != std::string::npos;
    groups[has_dot ? path.substr(0, dot) : ""].push_back(
        fmt::format("{}: {}", sim::key_text(has_dot ? path.substr(dot + 1) : path), value));
  }
  std::string out;
  for (const auto& [group, members] : groups) {
    out += fmt::format("      {}: {{{}}}\n", sim::key_text(group), fmt::join(members, ", "));
  }
  return out;
}

std::string draws_text(const StoredDraws& draws) {
  std::string out = draws.empty() ? "" : "    replicates:\n";
  for (const auto& [path, d] : draws) {
    out += fmt::format("      {}: {{count: {}, mean: {}, deviation: {}}}\n", sim::key_text(path), d.count, d.mean,
                       d.deviation);
  }
  return out;
}

}  // namespace

Suite load_suite(const std::filesystem::path& file) { return SuiteReader(file).read(); }

Baseline load_baseline(const std::filesystem::path& file) { return BaselineReader(file).read(); }

std::string baseline_text(const Baseline& baseline, const Suite& suite) {
  const FlatConfig common = common_config(baseline);
  std::string out = fmt::format(
      "# What the runs of {} gave, written by 'raywatt baseline'; do not edit, accept. Zeros are left out.\n"
      "schema: {}\nembree: {}\nconfig:  # where a run says nothing else\n",
      sim::printable(suite.file.filename().string()), kSchema, yaml_scalar(baseline.embree));
  for (const auto& [key, value] : common) out += fmt::format("  {}: {}\n", sim::key_text(key), yaml_scalar(value));
  out += "runs:\n";
  for (const SuiteRun& named : suite.runs) {
    const StoredRun& run = baseline.runs.at(named.name);
    out += fmt::format("  {}:\n    program: {}\n    scene_sha256: {}\n    bvh_hash: {}\n", sim::key_text(named.name),
                       yaml_scalar(run.facts.program), yaml_scalar(run.facts.scene_sha256),
                       yaml_scalar(run.facts.bvh_hash));
    std::vector<std::string> own;
    for (const auto& [key, value] : run.facts.config) {
      const auto at = common.find(key);
      if (at == common.end() || at->second != value)
        own.push_back(fmt::format("{}: {}", sim::key_text(key), sim::double_quoted(value)));
    }
    out += fmt::format("    config: {{{}}}\n{}    values:\n{}", fmt::join(own, ", "), draws_text(run.draws),
                       values_text(run.values));
  }
  return out;
}

}  // namespace tools
