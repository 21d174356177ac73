#pragma once
#include <string>

#include "sim/io/json.h"

namespace traces::gltf {

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
