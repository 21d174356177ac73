#include "tools/studies/baseline/changed_keys.h"

#include <algorithm>

#include <fmt/format.h>

#include "hw_models/machines/unit_kinds.h"

namespace tools {
namespace {

/// A kind of units as its configuration group would be named: "tni.trv" of "core.tni.trv".
std::string_view without_core(std::string_view kind) {
  constexpr std::string_view kCore = "core.";
  return kind.starts_with(kCore) ? kind.substr(kCore.size()) : kind;
}

/// The kind of units of a configuration group; empty if there is none or more than one.
std::string_view kind_of_group(std::string_view group) {
  std::string_view inside;
  std::size_t kinds_inside = 0;
  for (const hw::UnitKind& kind : hw::kUnitKinds) {
    if (without_core(kind.name) == group) return kind.name;
    if (!is_part_of(kind.name, group)) continue;
    inside = kind.name;
    kinds_inside += 1;
  }
  return kinds_inside == 1 ? inside : std::string_view();
}

/// "dram.timing" of "dram.timing.rcd"; empty for a key without a group.
std::string_view group_of(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : key.substr(0, dot);
}

}  // namespace

ChangedKeys changed_keys(const FlatConfig& was, const FlatConfig& is) {
  ChangedKeys out;
  for (const auto& [key, before] : was) {
    const auto after = is.find(key);
    if (after == is.end()) {
      out.of_one.push_back({key, before, "none"});
    } else if (before != after->second) {
      out.changed.push_back({key, before, after->second});
    }
  }
  for (const auto& [key, after] : is) {
    if (!was.contains(key)) out.of_one.push_back({key, "none", after});
  }
  std::ranges::stable_sort(out.of_one, {}, &KeyPair::key);
  return out;
}

std::string unit_of_key(std::string_view key) {
  std::string_view group = key;
  for (std::size_t dot = key.rfind('.'); dot != std::string_view::npos; dot = group.rfind('.')) {
    group = group.substr(0, dot);
    if (const std::string_view kind = kind_of_group(group); !kind.empty()) return std::string(kind);
  }
  return group == key ? std::string() : std::string(group);
}

bool is_part_of(std::string_view kind, std::string_view unit) {
  const std::string_view name = without_core(kind);
  return kind == unit || (name.starts_with(unit) && name.size() > unit.size() && name[unit.size()] == '.');
}

std::string changed_text(const KeyPair& key) { return fmt::format("{} was {}, is {}", key.key, key.a, key.b); }

std::string changed_text(const std::vector<KeyPair>& keys) {
  constexpr std::ptrdiff_t kMostOfGroup = 4;
  std::vector<std::string> units;
  for (const KeyPair& key : keys) {
    std::string unit = unit_of_key(key.key);
    if (std::ranges::find(units, unit) == units.end()) units.push_back(std::move(unit));
  }
  std::string out;
  for (const std::string& unit : units) {
    std::string_view shown;  // group of the last line
    for (const KeyPair& key : keys) {
      if (unit_of_key(key.key) != unit) continue;
      const std::string_view group = group_of(key.key);
      const auto others = std::ranges::count(keys, group, [](const KeyPair& k) { return group_of(k.key); }) - 1;
      const bool is_many = !group.empty() && others >= kMostOfGroup;
      if (is_many && group == shown) continue;
      shown = group;
      out += fmt::format("Changed{}: {}{}\n", unit.empty() ? "" : " in " + unit, changed_text(key),
                         is_many ? fmt::format(", and {} more keys of {}", others, group) : "");
    }
  }
  return out;
}

}  // namespace tools
