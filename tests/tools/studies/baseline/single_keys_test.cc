#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hw_models/machines/unit_kinds.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "tests/full_size.h"
#include "tests/tools/program.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/baseline/check.h"

// Tests that after a change of one key of the default machine the check names the key's unit first.

namespace test {
namespace {

using sim::FieldInfo;
using sim::FieldKind;

/// Number of changes to test, and of those that must be named.
const std::uint64_t kChanges = full_or(40U, 10U), kLeastNamed = full_or(36U, 9U);

struct Change {
  FieldInfo field;
  std::string value;
};

/// Returns other values for a field: double or half of a number, the next name of a list.
std::vector<std::string> other_values(const FieldInfo& field) {
  if (field.kind == FieldKind::kBool) return {field.value == "true" ? "false" : "true"};
  if (field.kind == FieldKind::kEnum) {
    const auto at = std::ranges::find(field.choices, field.value);
    const auto next = at == field.choices.end() || at + 1 == field.choices.end() ? field.choices.begin() : at + 1;
    return {*next};
  }
  std::istringstream text(field.value);
  double number = 0;
  std::string unit;
  if (!(text >> number)) return {};
  std::getline(text, unit);
  std::vector<std::string> out;
  for (const double other : {2 * number, number / 2, number + 1}) out.push_back(fmt::format("{}{}", other, unit));
  return out;
}

/// Returns the first other value that the configuration allows.
std::optional<Change> change_of(const FieldInfo& field) {
  for (const std::string& value : other_values(field)) {
    tools::JobOptions options;
    options.scene = "cornell";
    options.sets = {field.path + "=" + value};
    try {
      const std::vector<FieldInfo> fields = sim::list_fields(tools::load_run_config(options));
      if (std::ranges::find(fields, field.path, &FieldInfo::path)->value != field.value) return Change{field, value};
    } catch (const sim::InputError&) {  // tries the next value
    }
  }
  return {};
}

/// Returns random changes. Each is drawn as a group of keys and then one of its keys; no key is drawn twice.
std::vector<Change> drawn_changes() {
  tools::JobOptions options;
  options.scene = "cornell";
  std::map<std::string, std::vector<FieldInfo>> groups;
  for (const FieldInfo& field : sim::list_fields(tools::load_run_config(options))) {
    const std::size_t dot = field.path.find('.');
    groups[dot == std::string::npos ? "" : field.path.substr(0, dot)].push_back(field);
  }
  std::vector<Change> out;
  std::set<std::string> drawn;
  for (std::uint64_t n = 0; out.size() < kChanges; ++n) {
    const auto group = std::next(groups.begin(), static_cast<std::ptrdiff_t>(sim::hash(n, 0) % groups.size()));
    const FieldInfo& field = group->second[sim::hash(n, 1) % group->second.size()];
    const bool is_overridden = field.path == "render.width" || field.path == "render.height";  // the suite sets these
    if (is_overridden || !drawn.insert(field.path).second) continue;
    if (auto change = change_of(field)) out.push_back(*std::move(change));
  }
  return out;
}

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> out(1);
  for (const char c : line) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '@') {
      out.back() += c;
    } else if (!out.back().empty()) {
      out.emplace_back();
    }
  }
  return out;
}

/// True if a word of the line is a unit, a key, or the path of a counter.
bool names_unit_or_key(const std::string& line, const std::set<std::string>& keys) {
  if (line.find("interconnect between") != std::string::npos || line.find("path between") != std::string::npos)
    return true;
  return std::ranges::any_of(words_of(line), [&](std::string word) {
    while (word.ends_with('.')) word.pop_back();
    if (keys.contains(word)) return true;
    if (word.starts_with("units.")) word = word.substr(6);
    return std::ranges::any_of(hw::kUnitKinds, [&](const hw::UnitKind& kind) {
      return word == kind.name || word.starts_with(std::string(kind.name) + ".");
    });
  });
}

/// Returns the first line of the output of a check that names a unit or a key.
std::string first_named(const std::string& out, const std::set<std::string>& keys) {
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    if (names_unit_or_key(line, keys)) return line;
  }
  return {};
}

class Suite {
 public:
  void write(const std::string& set) {
    file_ = folder_
                .write("suite.yaml",
                       "keep: {cycles: exact, rays: exact, energy_mj: 0.000001 %, units: exact}\n"
                       "defaults: {scene: cornell, resolution: 32x32}\nruns: {frame: {set: {" +
                           set + "}}}\n")
                .string();
  }
  ProcessResult run(const char* step) const { return raywatt({"baseline", step, file_}); }

 private:
  TempFolder folder_;
  std::string file_;
};

TEST(SingleKey, IsNamedWithItsUnitFirst) {
  std::set<std::string> keys;
  for (const FieldInfo& field : sim::list_fields(tools::RunConfig{})) keys.insert(field.path);
  Suite suite;
  suite.write("");
  ASSERT_EQ(suite.run("record").exit, 0);
  std::size_t named = 0;
  std::string table;
  for (const Change& change : drawn_changes()) {
    suite.write(fmt::format("{}: \"{}\"", change.field.path, change.value));
    const ProcessResult ending = suite.run("check");
    const std::string line = first_named(ending.out, keys);
    const std::string unit = tools::unit_of_key(change.field.path);
    const bool is_refusal = ending.exit == 2;  // other rays are rendered, so only the key can be named
    const bool is_right = line.find(change.field.path + " was ") != std::string::npos &&
                          (is_refusal || unit.empty() || line.find("in " + unit + ":") != std::string::npos);
    named += is_right ? 1 : 0;
    table += fmt::format("{} {}={}: {}\n", is_right ? "right" : "WRONG", change.field.path, change.value, line);
    EXPECT_EQ(ending.out.find("-> -"), std::string::npos) << "a negative count\n" << ending.out;
    EXPECT_FALSE(std::regex_search(ending.out, std::regex(" -[0-9]+ ->"))) << "a negative count\n" << ending.out;
  }
  EXPECT_GE(named, kLeastNamed) << table;
}

}  // namespace
}  // namespace test
