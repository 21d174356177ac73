#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <tiny_gltf.h>

#include "traces/scene/gltf/budget.h"
#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces::gltf {

/// State that all parts of the glTF reader share: the parsed file, and the scene that they fill.
struct Context {
  std::string file;  ///< name of the file, as printed in messages
  const tinygltf::Model& model;
  const SceneLimits& limits;
  Budget& budget;
  Scene& scene;
  std::vector<std::uint32_t> scene_nodes{};  ///< for each node of the file, its index in Scene::nodes; kNone: not shown

  /// Throws InputError with the file's name and `reason`.
  [[noreturn]] void refuse(const std::string& reason) const;

  /// Adds a line to the scene's warnings, unless it is there already.
  void add_warning(const std::string& what);

  /// Returns `list[index]`. Throws InputError if there is no such entry; `what` names the list.
  template <class T>
  const T& at(const std::vector<T>& list, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) refuse_index(what, index, list.size());
    return list[static_cast<std::size_t>(index)];
  }

  [[noreturn]] void refuse_index(const char* what, long long index, std::size_t size) const;
};

/// Converts a JSON number to float. Throws InputError if a float cannot represent it; `what` names the number.
float to_float(const Context& context, double value, const std::string& what);

/// Converts a JSON list of exactly three (to_vec4: four) numbers. Returns `absent` for an empty list.
glm::vec3 to_vec3(const Context& context, const std::vector<double>& list, const glm::vec3& absent,
                  const std::string& what);
glm::vec4 to_vec4(const Context& context, const std::vector<double>& list, const glm::vec4& absent,
                  const std::string& what);

/// Returns a unit quaternion from numbers x, y, z, w. Throws InputError if all are zero.
glm::quat to_rotation(const Context& context, const std::vector<double>& list, const std::string& what);

/// Returns `matrix` with its last row replaced by 0, 0, 0, 1, as glTF demands.
glm::mat4 to_affine(glm::mat4 matrix);

/// Returns the JSON object of the glTF extension called `name`, or null.
const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name);

/// Returns the number stored under `key` in an extension's object, or `absent`.
float number_or(const Context& context, const tinygltf::Value& object, const char* key, float absent);

/// Returns the list of three numbers stored under `key` in an extension's object, or `absent`.
glm::vec3 vec3_or(const Context& context, const tinygltf::Value& object, const char* key, const glm::vec3& absent);

/// Returns the count of bytes or elements stored under `key` in an extension's object, or `absent`. Throws InputError
/// if the value is not a count.
std::uint64_t count_or(const Context& context, const tinygltf::Value& object, const char* key, std::uint64_t absent);

/// Returns the index stored under `key` in an extension's object, or -1.
int index_or_none(const tinygltf::Value& object, const char* key);

}  // namespace traces::gltf
