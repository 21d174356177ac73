#include "tools/studies/worth/worth_file.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/config/config_tree.h"
#include "sim/config/yaml_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace tools::worth {
namespace {

using sim::YamlNode;
using sweep::YamlValue;
using Kind = YamlNode::Kind;
using NodePointer = std::shared_ptr<const YamlNode>;

constexpr std::uint64_t kMostBytes = 1 << 20;
constexpr std::string_view kSchema = "raywatt-worth/1";
/// Keys of a search's file that `without` and `with` may change.
constexpr std::array<std::string_view, 8> kSideKeys = {"config",      "program", "reference", "sets",
                                                       "constraints", "axes",    "exclude",   "where"};

NodePointer scalar_of(std::string text) {
  const auto node = std::make_shared<YamlNode>();
  node->kind = Kind::kScalar;
  node->scalar = std::move(text);
  return node;
}

/// Returns the default objectives as YAML: [{min: area_mm2}].
NodePointer smallest_area() {
  const auto goal = std::make_shared<YamlNode>(), list = std::make_shared<YamlNode>();
  goal->kind = Kind::kMapping;
  goal->entries = {{"min", {}, {}, scalar_of("area_mm2")}};
  list->kind = Kind::kSequence;
  list->entries = {{"", {}, {}, goal}};
  return list;
}

void set_entry(std::vector<YamlNode::Entry>& entries, const YamlNode::Entry& entry) {
  const auto found = std::ranges::find(entries, entry.key, &YamlNode::Entry::key);
  if (found == entries.end()) {
    entries.push_back(entry);
  } else {
    *found = entry;
  }
}

/// Merges an entry of `without` or `with` into the search's entry: joins lists, replaces axes by name.
YamlNode::Entry merge_entries(const YamlNode::Entry& search, const YamlNode::Entry& side, const std::string& where) {
  const Kind kind = side.value->kind;
  if (kind != search.value->kind)
    sim::refuse(where, side.key, fmt::format("must have the form of the search's '{}'", side.key));
  if (kind != Kind::kSequence && kind != Kind::kMapping) return side;
  const auto merged = std::make_shared<YamlNode>(*search.value);
  for (const YamlNode::Entry& entry : side.value->entries) {
    if (kind == Kind::kSequence) {
      merged->entries.push_back(entry);
    } else {
      set_entry(merged->entries, entry);
    }
  }
  YamlNode::Entry entry = side;
  entry.value = merged;
  return entry;
}

/// Returns a YAML value as one line, in flow style.
std::string flow_text(const YamlNode& node) {
  const auto quoted = [](const std::string& text) { return sim::json_line(text); };
  if (node.kind == Kind::kEmpty) return "~";
  if (node.kind == Kind::kScalar) return quoted(node.scalar);
  const bool is_mapping = node.kind == Kind::kMapping;
  std::string text(1, is_mapping ? '{' : '[');
  for (const YamlNode::Entry& entry : node.entries) {
    if (text.size() > 1) text += ", ";
    if (is_mapping) text += quoted(entry.key) + ": ";
    text += flow_text(*entry.value);
  }
  return text + (is_mapping ? '}' : ']');
}

/// Returns the search of one side. `changes`: the value of the key `without` or `with`.
SideSearch side_search(const YamlNode& root, const YamlValue& changes, const YamlNode& changed,
                       const std::string& name) {
  YamlNode search;
  search.kind = Kind::kMapping;
  for (const YamlNode::Entry& entry : root.entries) {
    if (entry.key == "feature" || entry.key == "without" || entry.key == "with") continue;
    search.entries.push_back(entry);
    if (entry.key == "schema") search.entries.back().value = scalar_of(std::string(optimise::kSchema));
  }
  if (search.find("objectives") == nullptr) search.entries.push_back({"objectives", {}, {}, smallest_area()});
  const std::vector<YamlValue> values = changes.entries(kSideKeys);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const YamlNode::Entry& entry = changed.entries[i];
    const YamlNode::Entry* const former = search.find(entry.key);
    set_entry(search.entries, former == nullptr ? entry : merge_entries(*former, entry, values[i].where()));
  }
  SideSearch side{optimise::parse_task(search, name), {}};
  for (const YamlNode::Entry& entry : search.entries) {
    side.text += fmt::format("{}: {}\n", entry.key,
                             entry.key == "schema" ? std::string(optimise::kSchema) : flow_text(*entry.value));
  }
  return side;
}

}  // namespace

WorthFile read_worth_file(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  const NodePointer tree = sim::parse_yaml_mapping(sim::read_file(file, kMostBytes), name);
  const YamlValue root(*tree, name);
  const YamlNode::Entry* const schema = tree->find("schema");
  if (schema == nullptr || schema->value->scalar != kSchema)
    root.refuse(fmt::format("the first line shall be 'schema: {}'", kSchema));
  WorthFile out;
  std::array<std::optional<YamlValue>, 2> changes;
  for (const YamlValue& entry : root.entries()) {
    if (entry.key() == "feature") out.feature = sim::printable(entry.text());
    for (const Side side : kSides) {
      const auto i = static_cast<std::size_t>(side);
      if (entry.key() == names_of(side).at(i)) changes.at(i).emplace(entry);
    }
  }
  if (out.feature.empty()) root.refuse("has no feature; allowed: e.g. feature: adaptive sampling");
  for (const Side side : kSides) {
    const auto i = static_cast<std::size_t>(side);
    const std::string key(names_of(side).at(i));
    if (!changes.at(i)) root.refuse(fmt::format("has no '{0}'; allowed: e.g. {0}: {{program: full:1}}", key));
    out.sides.at(i) = side_search(*tree, *changes.at(i), *tree->find(key)->value, name);
    const auto objectives = std::ranges::count_if(out.sides.at(i).task.goals,
                                                  [](const optimise::Goal& goal) { return goal.is_objective(); });
    if (objectives != 1) root.refuse("has two objectives; allowed: one");
  }
  out.question = out.sides.front().task.space.question;
  return out;
}

}  // namespace tools::worth
