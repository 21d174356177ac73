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
  /// Both trees must be bound to structs of one type with equal values, and must outlive this object.
  ConfigVariant(const ConfigNode& base, ConfigNode& variant);

  /// Copies the values and origins of the base configuration to the variant.
  void reset();
  /// Returns the hash that hash_tree() returns for the variant.
  std::string hash(std::optional<Affects> only) const;

 private:
  /// A field of both configurations, or a group without its fields.
  struct Node {
    const ConfigNode* base;
    ConfigNode* variant;
    std::size_t depth;
    std::string text;       ///< its lines in a dump of the base, without comments
    std::uint32_t affects;  ///< mask over Affects: of the field, or of all fields of the group
  };
  std::uint32_t add_node(const ConfigNode& base, ConfigNode& variant, std::size_t depth);

  std::vector<Node> nodes_;  ///< in dump order
  std::size_t bytes_ = 0;    ///< size of the dump
};

}  // namespace sim
