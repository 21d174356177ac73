#pragma once
#include <string>
#include <string_view>

#include "sim/config/config_tree.h"

namespace sim {

/// Multiplies each figure of a group by the factor of the longest key that covers it: low by low, high by high.
///
/// A key is a field of the group, or a field and the beginning of an entry's name: "events" covers all events,
/// "events.cache" covers "cache.l1_read@16KiB" and overrides "events" for it.
class FigureScale {
 public:
  /// Adds a key and its factor.
  void add(std::string key, const Band& factor) { factors_[std::move(key)] = factor; }
  /// Returns the longest key that covers `path`, which is relative to the group; empty if none does.
  std::string covering_key(std::string_view path) const;
  /// Multiplies each figure of `group` by the factor of its longest covering key. Returns a key that covers no figure,
  /// or an empty string if there is none.
  std::string apply(ConfigNode& group) const;

 private:
  std::map<std::string, Band, std::less<>> factors_;
};

}  // namespace sim
