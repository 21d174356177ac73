#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace traces::gltf {

/// JSON type of a property: kIndex is a whole number that fits an int, kCount any whole number of 0 or more.
enum class PropertyType : std::uint8_t { kObject, kIndex, kCount, kNumber, kText, kBoolean };

/// A property of a kind of object.
struct Property {
  std::string_view name;  ///< "*": every member of the object
  PropertyType type;
  std::string_view kind{};  ///< of a kObject, in object_kinds()
  bool is_list = false;
  bool required = false;
  std::size_t size = 0;                                     ///< of a list; 0: any
  double least = -std::numeric_limits<double>::infinity();  ///< of a kNumber
  double most = std::numeric_limits<double>::infinity();
  bool is_above = false;  ///< `least` itself is not allowed
  std::string_view
      allowed{};  ///< for messages, if the type does not say it; of an enumeration: its values, separated by blanks
  bool is_choice = false;
};

using ObjectKinds = std::map<std::string_view, std::vector<Property>>;

/// Returns the objects of glTF 2.0, section 5, by names of our own; "glTF" is the document.
const ObjectKinds& object_kinds();

/// Returns the supported extensions with the properties of all their objects.
const ObjectKinds& extension_kinds();

bool is_supported_extension(std::string_view name);

/// Returns all names, for a message.
std::string supported_extensions();

/// Checks the JSON against the properties of glTF 2.0 and of the supported extensions, as tinygltf ignores properties
/// of the wrong type. Throws InputError, with the path of the property and what is allowed, if
///
/// - a value has another JSON type, or a required property is missing;
/// - an index is negative or not a whole number;
/// - a value is not one of an enumeration's;
/// - a number of a material or camera exceeds its range by more than 1e-6; the reader clamps smaller deviations.
///
/// Not checked: properties that glTF does not define, extras, other extensions. `name`: of the file.
void check_properties(const sim::Json& json, const std::string& name);

}  // namespace traces::gltf
