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

/// State shared by all parts of the reader: the parsed file and the scene being filled.
struct Context {
  std::string file;  ///< as printed in messages
  const tinygltf::Model& model;
  const SceneLimits& limits;
  Budget& budget;
  Scene& scene;
  std::vector<std::uint32_t> scene_nodes{};  ///< Scene::nodes index of each of the file's nodes; kNone: not shown

  /// Throws InputError.
  [[noreturn]] void refuse(const std::string& why) const;

  /// Adds to the scene's warnings, each text once.
  void warn(const std::string& what);

  /// Returns `list[index]`; refused if there is no such entry. `what` names the list.
  template <class T>
  const T& at(const std::vector<T>& list, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) refuse_index(what, index, list.size());
    return list[static_cast<std::size_t>(index)];
  }

  [[noreturn]] void refuse_index(const char* what, long long index, std::size_t size) const;
};

/// Converts a JSON number to float; refused if it does not fit.
float to_float(const Context& context, double value, const std::string& what);

/// Convert a list of exactly three or four numbers; an empty list gives `absent`.
glm::vec3 to_vec3(const Context& context, const std::vector<double>& list, const glm::vec3& absent,
                  const std::string& what);
glm::vec4 to_vec4(const Context& context, const std::vector<double>& list, const glm::vec4& absent,
                  const std::string& what);

/// Returns a unit quaternion from x, y, z, w; refused if it is zero.
glm::quat to_rotation(const Context& context, const std::vector<double>& list, const std::string& what);

/// Returns the matrix with 0, 0, 0, 1 as its last row, which glTF demands.
glm::mat4 to_affine(glm::mat4 matrix);

/// Returns the object of that extension, or null.
const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name);

/// Returns a number of an extension's object, or `absent`.
float number_or(const Context& context, const tinygltf::Value& object, const char* key, float absent);

/// Returns a list of three numbers of an extension's object, or `absent`.
glm::vec3 vec3_or(const Context& context, const tinygltf::Value& object, const char* key, const glm::vec3& absent);

/// Returns a count of bytes or elements of an extension's object, or `absent`; refused if it is not a count.
std::uint64_t size_or(const Context& context, const tinygltf::Value& object, const char* key, std::uint64_t absent);

/// Returns an index of an extension's object, or -1.
int index_or_none(const tinygltf::Value& object, const char* key);

}  // namespace traces::gltf
