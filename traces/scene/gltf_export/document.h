#pragma once
#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <tiny_gltf.h>

#include "traces/scene/scene.h"

namespace traces::gltf_export {

/// The glTF document that is being written, with its single buffer.
class Document {
 public:
  tinygltf::Model model;

  /// What a buffer view is used for, which glTF validators check.
  enum class Use { kVertices, kIndices, kOther };

  // Each of these functions appends a buffer view and an accessor, and returns the accessor's index. Minimum and
  // maximum are written where glTF demands them.
  int add_array(std::span<const float> values, bool bounds);
  int add_array(std::span<const glm::vec2> values);
  int add_array(std::span<const glm::vec3> values, bool bounds = false, Use use = Use::kVertices);
  int add_array(std::span<const glm::vec4> values, Use use = Use::kVertices);
  int add_array(std::span<const glm::mat4> values);
  int add_array(std::span<const std::array<std::uint16_t, 4>> values);
  /// Appends the vertex indices of triangles; `wide` selects 32 bits per index instead of 16.
  int add_array(std::span<const std::array<std::uint32_t, 3>> triangles, bool wide);

  int add_view(std::span<const std::byte> bytes, Use use = Use::kOther);

  /// Adds an extension with its object, and lists the extension as used.
  void add_extension(tinygltf::ExtensionMap& extensions, const char* name, tinygltf::Value::Object object);

  /// Returns the bytes of the GLB file and empties the document.
  std::string glb_bytes() &&;

 private:
  int add_accessor(std::span<const std::byte> bytes, int component, int type, std::size_t count, Use use);

  std::vector<unsigned char> buffer_;
  std::set<std::string> used_;
};

std::vector<double> to_numbers(const glm::vec3& v);
std::vector<double> to_numbers(const glm::vec4& v);
tinygltf::Value to_value(const glm::vec3& v);
tinygltf::Value to_value(float number);

}  // namespace traces::gltf_export
