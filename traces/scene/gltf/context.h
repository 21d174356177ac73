#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "traces/scene/gltf/budget.h"
#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces::gltf {

/// Data that every part of the reader works on: the parsed file on one side, the scene being filled on the other.
struct Context {
  std::string file;  ///< as shown in messages
  const tinygltf::Model& model;
  const SceneLimits& limits;
  Budget& budget;
  Scene& scene;
  std::vector<std::uint32_t> scene_nodes{};  ///< index of each of the file's nodes in Scene::nodes; kNone: not shown

  /// Throws InputError.
  [[noreturn]] void refuse(const std::string& why) const;

  /// Adds to the scene's warnings, once.
  void warn(const std::string& what);

  /// `list[index]`, refused if there is no such entry; `what` names the list.
  template <class T>
  const T& at(const std::vector<T>& list, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) refuse_index(what, index, list.size());
    return list[static_cast<std::size_t>(index)];
  }

  [[noreturn]] void refuse_index(const char* what, long long index, std::size_t size) const;
};

}  // namespace traces::gltf
