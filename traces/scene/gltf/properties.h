#pragma once
#include <string>

#include "sim/io/json.h"

namespace traces::gltf {

/// Checks the JSON against the properties of glTF 2.0 and of the supported extensions. InputError, with the path of the
/// property and what is allowed, if
///
/// - a value is of another JSON type, or a required property is missing;
/// - an index is negative or no whole number;
/// - a value is not one of the few that are allowed;
/// - a quantity of a material or camera is out of its range by more than 1e-6. Rounding errors are left to the reader,
///   which clamps them.
///
/// tinygltf ignores properties of the wrong type. Not checked: properties that glTF does not define, extras, other
/// extensions. `name`: of the file.
void check_properties(const sim::Json& json, const std::string& name);

}  // namespace traces::gltf
