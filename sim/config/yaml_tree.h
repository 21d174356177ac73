#pragma once
#include <memory>
#include <string>
#include <vector>

namespace sim {

/// A position in a text. Line and column count from 1.
struct TextPosition {
  int line = 1;
  int column = 1;
};

/// A parsed YAML value. Aliases share the node of their anchor, so memory is proportional to the size of the text.
struct YamlNode {
  enum class Kind : std::uint8_t { kEmpty, kScalar, kMapping, kSequence };
  struct Entry {
    std::string key;
    TextPosition key_at;
    TextPosition value_at;
    std::shared_ptr<const YamlNode> value;
  };

  Kind kind = Kind::kEmpty;
  std::string scalar;
  std::vector<Entry> entries;  ///< entries in the order of the text; items of a sequence have no key

  const Entry* find(std::string_view key) const;
};

/// Parses a YAML text that contains one mapping. Throws InputError("<name>:<line>:<column>: <problem>") for anything
/// else: invalid YAML, an empty text, several documents, repeated keys, keys that are not scalars, tags, and aliases
/// inside their own anchor.
std::shared_ptr<const YamlNode> parse_yaml_mapping(const std::string& text, const std::string& name);

}  // namespace sim
