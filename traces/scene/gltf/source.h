#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "traces/scene/gltf/budget.h"
#include "traces/scene/limits.h"

namespace traces::gltf {

/// A glTF file, and the contents of all its URIs, in memory. The reader has checked chunk sizes, nesting depth, list
/// lengths, property types, required extensions, and that no URI leads out of the file's folder.
struct Source {
  std::string shown_name;  ///< name of the file in messages
  std::string bytes;
  bool binary = false;                          ///< the file is a GLB
  std::size_t json_begin = 0, json_size = 0;    ///< position and size of the JSON in `bytes`
  std::map<std::string, std::string> external;  ///< contents of all URIs, by the keys that replace the URIs in the JSON
  std::vector<std::size_t> lent;                ///< accessors to which make_parsable() has given a buffer view
  std::string sha256;                           ///< hash of the file, or of the digests of all files if it names others
};

Source read_source(const std::filesystem::path& path, const SceneLimits& limits, Budget& budget);

/// Returns the relative path that a URI encodes, with percent escapes decoded. Throws InputError, beginning with
/// `where`, if the URI has a scheme, is absolute or leaves the file's folder.
std::string local_path(std::string_view uri, std::string_view where);

/// True if `uri` is a data: URI (RFC 2397).
bool is_data_uri(std::string_view uri);

/// Returns the bytes of a data: URI of any media type. Throws InputError, beginning with `where`, if it is malformed.
std::string data_of(std::string_view uri, std::string_view where);

}  // namespace traces::gltf
