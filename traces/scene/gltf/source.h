#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "traces/scene/gltf/budget.h"
#include "traces/scene/limits.h"

namespace traces::gltf {

/// A glTF file and what its URIs name, in memory and checked: chunk sizes, depth, list lengths, types of properties,
/// extensions that must be understood, and where the URIs point.
struct Source {
  std::string shown_name;  ///< for messages
  std::string bytes;
  bool binary = false;                          ///< GLB
  std::size_t json_begin = 0, json_size = 0;    ///< in `bytes`
  std::map<std::string, std::string> external;  ///< bytes of what URIs name, by the keys that replace these in the JSON
  std::vector<std::size_t> lent;                ///< accessors that make_parsable() gave a buffer view
  std::string sha256;                           ///< hash of the file; where it names others, of all their digests
};

Source read_source(const std::filesystem::path& path, const SceneLimits& limits, Budget& budget);

}  // namespace traces::gltf
