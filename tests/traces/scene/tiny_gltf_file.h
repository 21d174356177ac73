#pragma once
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/temp_folder.h"
#include "traces/scene/gltf.h"

namespace test {

/// A glTF document for tests to change. It has one triangle (0,0,0), (1,0,0), (0,1,0) in one mesh on one node, with
/// indices and without normals. Accessor 0 holds the positions, 1 the indices.
struct TinyGltf {
  nlohmann::json json;
  std::string binary;

  TinyGltf();

  /// Appends values as a buffer view with an accessor. Returns the accessor's index.
  template <class T>
  int add(const std::vector<T>& values, int component_type, const std::string& type, std::size_t count,
          bool normalized = false) {
    return add_bytes(std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)),
                     component_type, type, count, normalized);
  }
  int add_bytes(const std::string& bytes, int component_type, const std::string& type, std::size_t count,
                bool normalized);
  int add_view(const std::string& bytes);

  nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }
  nlohmann::json& node() { return json["nodes"][0]; }
  nlohmann::json& material();

  std::string text() const;  ///< the bytes of a .gltf whose buffer is a data: URI
  std::string glb() const;
};

inline constexpr int kByte = 5120, kUByte = 5121, kShort = 5122, kUShort = 5123, kUInt = 5125, kFloat = 5126;

traces::Scene load(const TinyGltf& file, const traces::SceneLimits& limits = {});

/// Returns the loader's message for a file that it must refuse: one line that begins with the file's name.
std::string refusal(const std::string& bytes, const traces::SceneLimits& limits = {});

}  // namespace test
