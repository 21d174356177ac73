#pragma once
#include <string>

#include <nlohmann/json.hpp>

namespace traces::gltf {

/// InputError, with the property's place, if an index is negative or no whole number, or a value that stands for one of
/// a few things stands for none of them, or a quantity of materials and cameras is out of its range (glTF 2.0,
/// section 5). tinygltf takes the first for "not there", the others as they are. `name`: of the file.
void check_properties(const nlohmann::json& json, const std::string& name);

}  // namespace traces::gltf
