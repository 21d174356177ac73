#include "tools/studies/baseline/stored.h"

#include <charconv>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/config_tree.h"
#include "sim/config/value.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"

namespace tools {
namespace {

using Entry = sim::YamlNode::Entry;

constexpr std::uint64_t kLargestBaseline = 1ULL << 28;
constexpr const char* kSchema = "raywatt-baseline/1";

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  Baseline read() const {
    const auto root = sim::parse_yaml_mapping(sim::read_file(file_, kLargestBaseline), file_.string());
    const Entry* schema = root->find("schema");
    if (schema == nullptr || schema->value->scalar != kSchema) {
      refuse({}, "schema", fmt::format("must be {}; allowed: what 'raywatt baseline record' writes", kSchema));
    }
    Baseline out;
    FlatConfig usual;
    for (const Entry& entry : root->entries) {
      if (entry.key == "embree") out.embree = text(entry);
      if (entry.key == "config") usual = config(entry);
    }
    const Entry* runs = root->find("runs");
    if (runs == nullptr) refuse({}, "runs", "is missing");
    for (const Entry& entry : mapping(*runs)) {
      StoredRun& run = out.runs[entry.key] = read_run(entry);
      run.facts.config.insert(usual.begin(), usual.end());  // what the run itself says stays
    }
    return out;
  }

 private:
  [[noreturn]] void refuse(sim::TextPosition position, const std::string& key, const std::string& problem) const {
    sim::refuse(fmt::format("{}:{}:{}", file_.string(), position.line, position.column), key, problem);
  }
  /// Refuses control characters: terminals are shown what a baseline says.
  void check_printable(const std::string& text, sim::TextPosition position) const {
    if (sim::printable(text, std::string::npos) == text) return;
    refuse(position, {}, "holds what is no printable text; allowed: what 'raywatt baseline record' writes");
  }
  const std::string& text(const Entry& entry) const {
    if (entry.value->kind != sim::YamlNode::Kind::kScalar) refuse(entry.value_at, entry.key, "must be a plain value");
    check_printable(entry.value->scalar, entry.value_at);
    return entry.value->scalar;
  }
  const std::vector<Entry>& mapping(const Entry& entry) const {
    if (entry.value->kind != sim::YamlNode::Kind::kMapping) refuse(entry.value_at, entry.key, "must be a mapping");
    for (const Entry& inner : entry.value->entries) check_printable(inner.key, inner.key_at);
    return entry.value->entries;
  }
  FlatConfig config(const Entry& entry) const {
    FlatConfig out;
    for (const Entry& key : mapping(entry)) out[key.key] = text(key);
    return out;
  }
  double number(const Entry& entry) const {
    const std::string& digits = text(entry);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size())
      refuse(entry.value_at, entry.key, "must be a number");
    return value;
  }
  StoredDraws draws(const Entry& replicates) const {
    constexpr double kMostPlays = 1e6;
    StoredDraws out;
    for (const Entry& figure : mapping(replicates)) {
      Draws& d = out[figure.key];
      for (const Entry& entry : mapping(figure)) {
        const double value = number(entry);
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
    for (const Entry& entry : mapping(run)) {
      if (entry.key == "program") out.facts.program = text(entry);
      if (entry.key == "scene_sha256") out.facts.scene_sha256 = text(entry);
      if (entry.key == "bvh_hash") out.facts.bvh_hash = text(entry);
      if (entry.key == "config") out.facts.config = config(entry);
      if (entry.key == "replicates") out.draws = draws(entry);
      if (entry.key != "values") continue;
      for (const Entry& group : mapping(entry)) {
        for (const Entry& value : mapping(group)) {
          out.values[group.key.empty() ? value.key : group.key + "." + value.key] = number(value);
        }
      }
    }
    return out;
  }

  const std::filesystem::path& file_;
};

/// The value that most runs have of each key, if all have the key.
FlatConfig usual_config(const Baseline& baseline) {
  std::map<std::string, std::map<std::string, std::size_t>> counts;
  for (const auto& [name, run] : baseline.runs) {
    for (const auto& [key, value] : run.facts.config) counts[key][value] += 1;
  }
  FlatConfig usual;
  for (const auto& [key, values] : counts) {
    std::size_t runs = 0;
    auto most = values.begin();
    for (auto value = values.begin(); value != values.end(); ++value) {
      runs += value->second;
      if (value->second > most->second) most = value;
    }
    if (runs == baseline.runs.size()) usual[key] = most->first;
  }
  return usual;
}

/// Texts that YAML reads as they are need no quotes.
std::string scalar(const std::string& text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.:/ ";
  const bool plain = !text.empty() && text.find_first_not_of(kPlain) == std::string::npos && text.front() != ' ' &&
                     text.back() != ' ' && text.back() != ':' && text.find(": ") == std::string::npos && text != "null";
  return plain ? text : sim::double_quoted(text);
}

/// Values with one beginning share a line: "totals.rays: {primary: 2048, shadow: 2340}".
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

Baseline load_baseline(const std::filesystem::path& file) { return Reader(file).read(); }

std::string baseline_text(const Baseline& baseline, const Suite& suite) {
  const FlatConfig usual = usual_config(baseline);
  std::string out = fmt::format(
      "# What the runs of {} gave, written by 'raywatt baseline'; do not edit, accept. Zeros are left out.\n"
      "schema: {}\nembree: {}\nconfig:  # where a run says nothing else\n",
      sim::printable(suite.file.filename().string()), kSchema, scalar(baseline.embree));
  for (const auto& [key, value] : usual) out += fmt::format("  {}: {}\n", sim::key_text(key), scalar(value));
  out += "runs:\n";
  for (const SuiteRun& named : suite.runs) {
    const StoredRun& run = baseline.runs.at(named.name);
    out += fmt::format("  {}:\n    program: {}\n    scene_sha256: {}\n    bvh_hash: {}\n", sim::key_text(named.name),
                       scalar(run.facts.program), scalar(run.facts.scene_sha256), scalar(run.facts.bvh_hash));
    std::vector<std::string> own;
    for (const auto& [key, value] : run.facts.config) {
      const auto at = usual.find(key);
      if (at == usual.end() || at->second != value)
        own.push_back(fmt::format("{}: {}", sim::key_text(key), sim::double_quoted(value)));
    }
    out += fmt::format("    config: {{{}}}\n{}    values:\n{}", fmt::join(own, ", "), draws_text(run.draws),
                       values_text(run.values));
  }
  return out;
}

}  // namespace tools
