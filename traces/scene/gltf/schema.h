#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>
#include <vector>

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

}  // namespace traces::gltf
