#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/baseline/stored.h"
#include "tools/studies/compare/compare.h"

namespace tools {

/// Keys in which two configurations differ, in the order of their names.
struct ChangedKeys {
  std::vector<KeyPair> changed;  ///< keys of both, with other values
  std::vector<KeyPair> of_one;   ///< keys of one alone: another model, or another table; the missing value is "none"
};
ChangedKeys changed_keys(const FlatConfig& was, const FlatConfig& is);

/// Returns the unit that a configuration key belongs to, by the groups of the key from the innermost to the outermost:
///   1. the kind of units named like the group: "core.tni.trv" for "tni.trv.l1.size";
///   2. the kind of units inside the group, if there is only one: "l2.bank" for "l2.mshrs";
///   3. else the outermost group: "tni" for "tni.miss_handling", "clocks" for "clocks.tni".
/// Empty for a key without a group: "cores".
std::string unit_of_key(std::string_view key);

/// True if a unit kind is the unit that a key configures, or a subunit of it: "core.tni.trv" is part of "tni".
bool is_part_of(std::string_view kind, std::string_view unit);

/// "l2.mshrs was 32, is 8"
std::string changed_text(const KeyPair& key);
/// "Changed in l2.bank: l2.mshrs was 32, is 8", those of one unit together: a line for each key, or for a group of more
/// than four.
std::string changed_text(const std::vector<KeyPair>& keys);

}  // namespace tools
