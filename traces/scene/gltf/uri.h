#pragma once
#include <string>
#include <string_view>

namespace traces::gltf {

/// The relative path that a URI of a glTF file stands for, percent signs decoded. InputError, beginning with `where`,
/// if it has a scheme, is absolute or leaves the file's folder.
std::string local_path(std::string_view uri, std::string_view where);

}  // namespace traces::gltf
