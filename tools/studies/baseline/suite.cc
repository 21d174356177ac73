#include "tools/studies/baseline/suite.h"

#include <array>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config_tree.h"
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

/// One that says what a run consists of: a key, and the option that it sets.
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

class SuiteReader {
 public:
  explicit SuiteReader(const std::filesystem::path& file) : file_(file) {}

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
        for (const Entry& kept : mapping_of(entry)) suite.kept.push_back({kept.key, percent_of(kept), at(kept.key_at)});
      } else if (entry.key == "defaults") {
        fill(entry, defaults.options);
      } else if (entry.key == "runs") {
        runs = &entry;
      } else {
        unknown(entry, {"values", "keep", "defaults", "runs"});
      }
    }
    if (suite.kept.empty())
      sim::refuse(file_.string(), "keep", "is missing or empty; allowed: report paths, e.g. 'cycles: exact'");
    if (runs == nullptr || mapping_of(*runs).empty()) {
      sim::refuse(file_.string(), "runs", "is missing or empty; allowed: runs by name, e.g. 'teapot: {scene: teapot}'");
    }
    for (const Entry& entry : mapping_of(*runs)) {
      if (entry.key.empty() || sim::printable(entry.key) != entry.key) {
        sim::refuse(at(entry.key_at), "runs", "the name of a run must be 1 to 160 printable characters");
      }
      SuiteRun run = defaults;
      run.name = entry.key;
      if (entry.value->kind != Kind::kEmpty) fill(entry, run.options);
      check(entry, run);
      suite.runs.push_back(std::move(run));
    }
    return suite;
  }

 private:
  std::string at(sim::TextPosition position) const {
    return fmt::format("{}:{}:{}", file_.string(), position.line, position.column);
  }
  [[noreturn]] void unknown(const Entry& entry, const std::vector<std::string>& known) const {
    sim::refuse(
        at(entry.key_at), entry.key,
        fmt::format("is unknown{}; allowed: {}", traces::did_you_mean(entry.key, known), fmt::join(known, ", ")));
  }
  const std::string& text_of(const Entry& entry) const {
    if (entry.value->kind != Kind::kScalar) sim::refuse(at(entry.value_at), entry.key, "must be a plain value");
    return entry.value->scalar;
  }
  const std::vector<Entry>& mapping_of(const Entry& entry) const {
    if (entry.value->kind != Kind::kMapping)
      sim::refuse(at(entry.value_at), entry.key, "must be a mapping, 'key: value'");
    return entry.value->entries;
  }

  /// "exact", or "0.5 %".
  double percent_of(const Entry& entry) const {
    std::string text = text_of(entry);
    if (text == "exact") return 0;
    double percent = -1;
    if (text.ends_with('%')) {
      text.pop_back();
      text.erase(text.find_last_not_of(' ') + 1);
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), percent);
      if (error != std::errc() || end != text.data() + text.size()) percent = -1;
    }
    if (!(percent >= 0 && percent <= 100)) {
      sim::refuse(at(entry.value_at), entry.key, "allowed: exact, or a tolerance from 0 % to 100 %, e.g. 0.5 %");
    }
    return percent;
  }

  /// The path of a file that lies beside the suite; all else as it is.
  std::string beside(const std::string& name) const {
    const std::filesystem::path beside = file_.parent_path() / name;
    std::error_code ignored;
    return !name.empty() && std::filesystem::is_regular_file(beside, ignored) ? beside.string() : name;
  }

  void fill(const Entry& run, JobOptions& options) const {
    for (const Entry& entry : mapping_of(run)) {
      const auto* key =
          std::ranges::find(kRunKeys, entry.key, [](const RunKey& k) { return std::string_view(k.name); });
      if (key != kRunKeys.end()) {
        const bool may_be_file = entry.key == "config" || entry.key == "scene";
        options.*key->option = may_be_file ? beside(text_of(entry)) : text_of(entry);
      } else if (entry.key == "set") {
        for (const Entry& set : mapping_of(entry)) options.sets.push_back(set.key + "=" + text_of(set));
      } else {
        std::vector<std::string> known = {"set"};
        for (const RunKey& k : kRunKeys) known.emplace_back(k.name);
        unknown(entry, known);
      }
    }
  }

  void check(const Entry& entry, const SuiteRun& run) const {
    try {
      load_run_config(run.options);
      kernels::parse_program(run.options.program);
      if (!run.options.reference.empty()) kernels::parse_program(run.options.reference);
    } catch (const sim::InputError& error) {
      sim::refuse(at(entry.key_at), fmt::format("runs.{}", sim::printable(run.name)), error.what());
    }
  }

  const std::filesystem::path& file_;
};

}  // namespace

Suite load_suite(const std::filesystem::path& file) { return SuiteReader(file).read(); }

}  // namespace tools
