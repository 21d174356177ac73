#pragma once
#include <string>
#include <string_view>

namespace traces::gltf {

/// Returns the relative path of a URI, percent escapes decoded. Throws InputError, beginning with `where`, if it has a
/// scheme, is absolute or leaves the file's folder.
std::string local_path(std::string_view uri, std::string_view where);

/// True for a data: URI (RFC 2397).
bool is_data_uri(std::string_view uri);

/// Returns the bytes of a data: URI of any media type. Throws InputError, beginning with `where`, if the URI is
/// malformed.
std::string data_of(std::string_view uri, std::string_view where);

}  // namespace traces::gltf
