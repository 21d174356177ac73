#include "sim/config/config_tree.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/value.h"
#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

constexpr std::size_t kMostSuggested = 5;

void find_nodes_with_key(const ConfigNode& group, std::string_view key, std::vector<const ConfigNode*>& nodes) {
  for (const ConfigNode& child : group.children) {
    if (child.key == key) nodes.push_back(&child);
    find_nodes_with_key(child, key, nodes);
  }
}

/// True if an unknown key in `group` may have been meant as the configuration field `elsewhere` of another group. A
/// group without subgroups qualifies only if it has a field of the same type as `elsewhere`.
bool may_be_meant(const ConfigNode& elsewhere, const ConfigNode& group) {
  if (std::ranges::any_of(group.children, &ConfigNode::is_group)) return true;
  return !elsewhere.is_group() &&
         std::ranges::any_of(group.children, [&](const ConfigNode& child) { return child.kind() == elsewhere.kind(); });
}

void check_limits(const ConfigNode& node, std::string_view origin) {
  if (node.is_group()) {
    for (const ConfigNode& child : node.children) check_limits(child, child.origin.empty() ? origin : child.origin);
    return;
  }
  if (const std::string problem = value_problem(node); !problem.empty()) refuse(origin, node.path, problem);
}

/// Finds the settings in a group whose precedence (ConfigNode::nearness) is highest and above `than`. Adds their
/// origins (files, --set arguments) to `origins`, and sets `than` to their precedence.
void find_nearest_origins(const ConfigNode& group, std::size_t& than, std::vector<std::string>& origins) {
  for (const ConfigNode& child : group.children) {
    if (child.is_group()) {
      find_nearest_origins(child, than, origins);
      continue;
    }
    if (child.nearness > than) origins.clear();
    if (child.nearness > than || (child.nearness == than && !origins.empty())) {
      if (std::ranges::find(origins, child.origin) == origins.end()) origins.push_back(child.origin);
      than = child.nearness;
    }
  }
}

/// Throws InputError for a field that violates a rule of its group. If other fields of the group were set with a higher
/// precedence (ConfigNode::nearness), the error names the origins of these settings, because they caused it.
[[noreturn]] void throw_rule_violation(const ConfigNode& group, std::string_view at, std::size_t nearness,
                                       const std::string& path, std::string_view problem) {
  constexpr std::size_t kMostShown = 4;
  std::vector<std::string> origins;
  find_nearest_origins(group, nearness, origins);
  if (origins.empty() || at.starts_with(kSetOrigin)) refuse(at, path, problem);
  if (origins.size() > kMostShown) {
    origins.resize(kMostShown);
    origins.emplace_back("...");
  }
  refuse(fmt::format("{}", fmt::join(origins, ", ")), path, fmt::format("{} ({} has its value)", problem, at));
}

void check_rules(const ConfigNode& group, std::string_view origin) {
  for (const ConfigNode& child : group.children) check_rules(child, child.origin.empty() ? origin : child.origin);
  if (!group.check) return;
  group.check([&](std::string_view key, std::string_view problem) {
    const ConfigNode* named = &group;
    for (std::string_view rest = key; named != nullptr && !rest.empty();) {
      const std::size_t dot = rest.find('.');
      named = named->find_child(rest.substr(0, dot));
      rest = dot == std::string_view::npos ? std::string_view{} : rest.substr(dot + 1);
    }
    const std::string path = group.path.empty() ? std::string(key) : fmt::format("{}.{}", group.path, key);
    const bool is_given = named != nullptr && !named->origin.empty();
    // A default counts as set in the file, not by --set.
    throw_rule_violation(group, is_given ? std::string_view(named->origin) : origin,
                         is_given ? named->nearness : kNearestFile, path, problem);
  });
}

}  // namespace

ConfigNode::ConfigNode() = default;
ConfigNode::~ConfigNode() = default;
ConfigNode::ConfigNode(const ConfigNode&) = default;
ConfigNode::ConfigNode(ConfigNode&&) noexcept = default;
ConfigNode& ConfigNode::operator=(const ConfigNode&) = default;
ConfigNode& ConfigNode::operator=(ConfigNode&&) noexcept = default;

const ConfigNode* ConfigNode::find_child(std::string_view name) const {
  const auto found = std::ranges::find(children, name, &ConfigNode::key);
  return found == children.end() ? nullptr : &*found;
}

ConfigNode* ConfigNode::find_child(std::string_view name) {
  return const_cast<ConfigNode*>(std::as_const(*this).find_child(name));
}

ConfigNode& TreeBuilder::add_node(std::string_view key, std::string_view meaning) {
  assert(group_.find_child(key) == nullptr && "a key declared twice");
  ConfigNode& node = group_.children.emplace_back();
  node.key = key;
  if (!group_.path.empty()) node.path.append(group_.path).append(1, '.');
  node.path.append(key);
  node.meaning = meaning;
  return node;
}

void check_tree(const ConfigNode& root, std::string_view origin) {
  check_limits(root, origin);
  check_rules(root, origin);
}

void refuse(std::string_view origin, std::string_view path, std::string_view problem) {
  std::string line;
  for (const std::string_view part : {origin, path}) {
    if (!part.empty()) line += fmt::format("{}: ", part);
  }
  throw InputError(printable(line + std::string(problem), 2000));
}

std::string suggest_keys(const ConfigNode& root, const ConfigNode& group, std::string_view key) {
  std::vector<const ConfigNode*> same_name;
  find_nodes_with_key(root, key, same_name);
  std::vector<std::string> elsewhere;
  for (const ConfigNode* node : same_name) {
    if (may_be_meant(*node, group)) elsewhere.push_back(node->path);
  }
  if (!elsewhere.empty() && elsewhere.size() <= kMostSuggested)
    return fmt::format("did you mean '{}'?", fmt::join(elsewhere, "' or '"));
  const std::string_view start = comparison_prefix(key);
  const auto nearest =
      find_nearest(start, group.children, std::max<std::size_t>(1, start.size() / 3), &ConfigNode::key);
  if (nearest != group.children.end()) return fmt::format("did you mean '{}'?", nearest->path);
  std::vector<std::string_view> keys;
  for (const ConfigNode& child : group.children) keys.push_back(child.key);
  return fmt::format("allowed: {}", fmt::join(keys, ", "));
}

}  // namespace sim
