#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace traces::gltf {

/// JSON type of a glTF property: kIndex is an integer that fits an int, kCount any integer of 0 or more.
enum class PropertyType : std::uint8_t { kObject, kIndex, kCount, kNumber, kText, kBoolean };

/// Rule for one property of a kind of glTF object.
struct Property {
  std::string_view name;  ///< name of the property; "*" matches every member of the object
  PropertyType type;
  std::string_view kind{};  ///< for kObject: its kind in object_kinds()
  bool is_list = false;
  bool required = false;
  std::size_t size = 0;                                     ///< for a list: number of its elements; 0: any
  double least = -std::numeric_limits<double>::infinity();  ///< for kNumber: smallest value
  double most = std::numeric_limits<double>::infinity();
  bool is_above = false;       ///< `least` itself is not allowed
  std::string_view allowed{};  ///< text for messages on what is allowed, if the type does not make it clear; for an
                               ///< enumeration, its values, separated by blanks
  bool is_choice = false;
};

using ObjectKinds = std::map<std::string_view, std::vector<Property>>;

/// Returns the rules for all objects of glTF 2.0, section 5. The kinds of objects have names of our own; "glTF" is the
/// document.
const ObjectKinds& object_kinds();

/// Returns the rules for the supported extensions and all their objects.
const ObjectKinds& extension_kinds();

bool is_supported_extension(std::string_view name);

/// Returns the names of all supported extensions, for a message.
std::string supported_extensions();

/// Checks the JSON against the properties of glTF 2.0 and of the supported extensions, because tinygltf ignores
/// properties of the wrong type. Throws InputError, with the path of the property and what is allowed, if
///
/// - a value has another JSON type, or a required property is missing;
/// - an index is negative or not an integer;
/// - a value is not in the property's enumeration;
/// - a number of a material or camera exceeds its range by more than 1e-6; the reader clamps smaller deviations.
///
/// Not checked: properties that glTF does not define, extras, other extensions. `name` is the name of the file in
/// messages.
void check_properties(const sim::Json& json, const std::string& name);

}  // namespace traces::gltf
