#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/config/config_tree.h"

namespace sim {

/// A configuration that is changed, hashed and reset many times, as in a sweep. Only fields that differ from a base
/// configuration are written and hashed again.
class ConfigVariant {
 public:
  /// `base` and `variant` must be bound to structs of the same type with equal values, and must outlive the
  /// ConfigVariant.
  ConfigVariant(const ConfigNode& base, ConfigNode& variant);

  /// Resets the variant to the values and origins of the base configuration.
  void reset();
  /// Returns the same hash as hash_tree() for the variant, but faster.
  std::string hash(std::optional<Affects> only) const;

 private:
  /// One node of both configuration trees: a field, or a group without its fields.
  struct Node {
    const ConfigNode* base;
    ConfigNode* variant;
    std::size_t depth;
    std::string text;       ///< YAML lines of the node in the base configuration, without comments
    std::uint32_t affects;  ///< mask of the Affects values of the field, or of all fields of the group
  };
  std::uint32_t add_node(const ConfigNode& base, ConfigNode& variant, std::size_t depth);

  std::vector<Node> nodes_;  ///< nodes in the order of the YAML text
  std::size_t bytes_ = 0;    ///< size of the base configuration's YAML text
};

}  // namespace sim
