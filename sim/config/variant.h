#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/config/config_tree.h"

namespace sim {

/// A configuration that is changed, hashed and reset many times: only fields that differ from the base are written out.
class ConfigVariant {
 public:
  /// Both trees are bound to equal structs of one type, and outlive this.
  ConfigVariant(const ConfigNode& base, ConfigNode& variant);

  /// Copies values and origins of the base to the variant.
  void reset();
  /// Returns hash_tree() of the variant.
  std::string hash(std::optional<Affects> only) const;

 private:
  /// A field, or a group without its fields.
  struct Node {
    const ConfigNode* base;
    ConfigNode* variant;
    std::size_t depth;
    std::string text;       ///< its lines in a dump of the base, without comments
    std::uint32_t affects;  ///< bit set over Affects: of the field, or of any field of the group
  };
  std::uint32_t add(const ConfigNode& base, ConfigNode& variant, std::size_t depth);

  std::vector<Node> nodes_;  ///< in the order of a dump
  std::size_t bytes_ = 0;    ///< of that dump
};

}  // namespace sim
