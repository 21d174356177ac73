#pragma once
#include <string>
#include <string_view>

namespace traces::gltf {

bool is_supported_extension(std::string_view name);

/// Returns all names, for a message.
std::string supported_extensions();

}  // namespace traces::gltf
