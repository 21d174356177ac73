#include "tools/analysis/flat_config.h"

#include <nlohmann/json.hpp>

#include "sim/io/printable.h"

namespace tools {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kDeepest = 32;

/// Figures with a band stay together.
void flatten(const Json& node, const std::string& key, int depth, FlatConfig& out) {
  if (node.is_object() && node.size() == 3 && node.contains("nominal")) {
    out[sim::printable(key)] = sim::printable(node.dump());
  } else if (node.is_object() && depth < kDeepest) {
    for (const auto& [name, value] : node.items()) {
      flatten(value, key.empty() ? name : key + "." + name, depth + 1, out);
    }
  } else if (!node.is_structured()) {
    out[sim::printable(key)] = sim::printable(node.is_string() ? node.get<std::string>() : node.dump());
  }
}

}  // namespace

FlatConfig flat_config(const Json& config) {
  FlatConfig out;
  flatten(config, "", 0, out);
  return out;
}

}  // namespace tools
