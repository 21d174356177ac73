#include "traces/scene/gltf/compressed/rewrite.h"

#include <cstdint>
#include <utility>

#include <nlohmann/json.hpp>

namespace traces::gltf {
namespace {

using nlohmann::json;

json* member(json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

json* extension(json& object, const char* name) {
  json* extensions = member(object, "extensions");
  return extensions == nullptr ? nullptr : member(*extensions, name);
}

/// Calls visit(entry) for each entry of `object[key]`, if that is a list.
template <class Visit>
void for_each(json& object, const char* key, Visit visit) {
  json* list = member(object, key);
  if (list == nullptr || !list->is_array()) return;
  for (json& entry : *list) visit(entry);
}

/// `object[key][index]`, if there is such an entry.
json* entry(json& object, const char* key, const json& index) {
  json* list = member(object, key);
  if (list == nullptr || !list->is_array() || !index.is_number_unsigned()) return nullptr;
  const auto at = index.get<std::uint64_t>();
  return at < list->size() ? &(*list)[at] : nullptr;
}

}  // namespace

bool make_parsable(json& file) {
  bool changed = false;
  for_each(file, "buffers", [&](json& buffer) {
    if (extension(buffer, "EXT_meshopt_compression") == nullptr &&
        extension(buffer, "KHR_meshopt_compression") == nullptr) {
      return;
    }
    if (member(buffer, "uri") != nullptr) return;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    buffer["byteLength"] = 1;
    changed = true;
  });
  for_each(file, "meshes", [&](json& mesh) {
    for_each(mesh, "primitives", [&](json& primitive) {
      json* draco = extension(primitive, "KHR_draco_mesh_compression");
      const json* view = draco == nullptr ? nullptr : member(*draco, "bufferView");
      const json* indices = member(primitive, "indices");
      json* accessor = view == nullptr || indices == nullptr ? nullptr : entry(file, "accessors", *indices);
      if (accessor == nullptr || !accessor->is_object() || accessor->contains("bufferView")) return;
      (*accessor)["bufferView"] = *view;
      changed = true;
    });
  });
  return changed;
}

}  // namespace traces::gltf
