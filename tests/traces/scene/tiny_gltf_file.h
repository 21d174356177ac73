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

/// A glTF document that tests change. It has one mesh on one node: a triangle (0,0,0), (1,0,0), (0,1,0) with indices
/// and without normals. Accessor 0 has the positions, accessor 1 the indices.
struct TinyGltf {
  nlohmann::json json;
  std::string binary;

  TinyGltf();

  /// Appends values to the buffer, with a new buffer view and accessor. Returns the accessor's index.
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

  std::string text() const;  ///< returns a .gltf file whose buffer is a data: URI
  std::string glb() const;
};

inline constexpr int kByte = 5120, kUByte = 5121, kShort = 5122, kUShort = 5123, kUInt = 5125, kFloat = 5126;

traces::Scene load(const TinyGltf& file, const traces::SceneLimits& limits = {});

/// Returns the loader's error message for a file that it must refuse. Expects one line that begins with the name.
std::string refusal(const std::string& bytes, const traces::SceneLimits& limits = {});

}  // namespace test
