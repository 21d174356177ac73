#pragma once
#include <cstdint>
#include <string>
#include <vector>

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

}  // namespace traces::gltf
