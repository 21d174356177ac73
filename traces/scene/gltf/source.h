#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "traces/scene/gltf/budget.h"
#include "traces/scene/limits.h"

namespace traces::gltf {

/// A glTF file and the files it names, in memory and checked for what would break the JSON reader: chunk sizes, depth,
/// list lengths, extensions that must be understood, and where its URIs point.
struct Source {
  std::string shown_name;  ///< for messages
  std::string bytes;
  bool binary = false;                          ///< GLB
  std::size_t json_begin = 0, json_size = 0;    ///< in `bytes`
  std::map<std::string, std::string> external;  ///< by decoded relative URI
  std::string sha256;                           ///< hash of the file; where it names others, of all their digests
};

Source read_source(const std::filesystem::path& path, const SceneLimits& limits, Budget& budget);

}  // namespace traces::gltf
