#pragma once
#include <string>

#include <nlohmann/json.hpp>

namespace traces::gltf {

/// InputError, with the property's place, if an index is negative or no whole number, or a value that stands for one of
/// a few things stands for none of them (glTF 2.0, section 5). tinygltf takes the former for "not there", the latter as
/// it is. `name`: of the file.
void check_properties(const nlohmann::json& json, const std::string& name);

}  // namespace traces::gltf
