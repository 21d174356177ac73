#include "sim/config/scale.h"

#include <set>

namespace sim {
namespace {

/// True if `key` equals `path`, or is the beginning of `path` up to a '.', '_' or '@'.
bool covers(std::string_view key, std::string_view path) {
  if (!path.starts_with(key)) return false;
  return path.size() == key.size() || path[key.size()] == '.' || path[key.size()] == '_' || path[key.size()] == '@';
}

Band product(const Band& a, const Band& b) { return {a.low * b.low, a.nominal * b.nominal, a.high * b.high}; }

}  // namespace

std::string BandScale::covering_key(std::string_view path) const {
  std::string_view longest;
  for (const auto& [key, factor] : factors_) {
    if (covers(key, path) && key.size() > longest.size()) longest = key;
  }
  return std::string(longest);
}

std::string BandScale::apply(ConfigNode& group) const {
  std::set<std::string> used;
  const auto scale = [&](const std::string& path, Band& figure) {
    const std::string key = covering_key(path);
    if (key.empty()) return;
    figure = product(figure, factors_.find(key)->second);
    used.insert(key);
  };
  for (ConfigNode& node : group.children) {
    if (node.is_group()) continue;
    if (node.kind() == FieldKind::kBand) scale(node.key, *std::get<Band*>(*node.target));
    if (node.kind() != FieldKind::kBandMap) continue;
    for (auto& [name, figure] : *std::get<std::map<std::string, Band>*>(*node.target)) {
      scale(node.key + "." + name, figure);
    }
  }
  for (const auto& [key, factor] : factors_) {
    if (!used.contains(key)) return key;
  }
  return {};
}

}  // namespace sim
