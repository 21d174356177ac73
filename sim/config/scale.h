#pragma once
#include <string>
#include <string_view>

#include "sim/config/config_tree.h"

namespace sim {

/// Multiplies each Band (low, nominal and high value) of a configuration group by the factor of the longest key that
/// covers it: low by low, nominal by nominal, high by high.
///
/// A key is a field of the group, or a field and the beginning of an entry's name. "events" covers all entries of field
/// `events`. "events.cache" covers the entry "cache.l1_read@16KiB" and overrides "events" for it.
class BandScale {
 public:
  /// Adds a key and the factor of the values that it covers.
  void add(std::string key, const Band& factor) { factors_[std::move(key)] = factor; }
  /// Returns the longest key that covers `path`, a path relative to the configuration group; empty if no key does.
  std::string covering_key(std::string_view path) const;
  /// Multiplies each value of `group` by the factor of its longest covering key. Returns a key that covers no value, or
  /// an empty string if there is none.
  std::string apply(ConfigNode& group) const;

 private:
  std::map<std::string, Band, std::less<>> factors_;
};

}  // namespace sim
