#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/config/config_tree.h"
#include "sim/io/json.h"

namespace sim {

/// Description of one field of a configuration, with its value. The argument --set <path>=<value> restores the value.
struct FieldInfo {
  std::string path;  ///< dotted path of the field: "tni.trv.rays"
  FieldKind kind = FieldKind::kBool;
  std::string unit;
  std::string meaning;
  Limits limits;
  Affects affects = Affects::kTiming;
  std::string value;
  std::vector<std::string> choices;  ///< names of the values, if the field is an enumeration
};

enum class Comments : std::uint8_t { kOff, kOn };

// Text, hash and schema of a configuration tree. The functions of config.h do the same for configuration structs.
std::string dump_tree(const ConfigNode& root, Comments comments, std::optional<Affects> only = {});
std::string hash_tree(const ConfigNode& root, std::optional<Affects> only);
std::vector<FieldInfo> fields_of(const ConfigNode& root);
Json json_of(const ConfigNode& root);
Json schema_of(const ConfigNode& root);
std::string manual_of(const ConfigNode& root);

/// Returns the YAML lines of one field, or the lines of a group without those of its fields. `depth`: number of
/// enclosing groups.
std::string dump_node(const ConfigNode& node, std::size_t depth, Comments comments);

}  // namespace sim
