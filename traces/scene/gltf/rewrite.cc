#include "traces/scene/gltf/rewrite.h"

#include <cstdint>
#include <utility>

#include "sim/io/json.h"

namespace traces::gltf {
namespace {

using json = sim::Json;

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

/// Returns `object[key][index]`, or null if there is no such entry.
json* entry(json& object, const char* key, const json& index) {
  json* list = member(object, key);
  if (list == nullptr || !list->is_array() || !index.is_number_unsigned()) return nullptr;
  const auto at = index.get<std::uint64_t>();
  return at < list->size() ? &(*list)[at] : nullptr;
}

}  // namespace

bool make_parsable(json& file, std::vector<std::size_t>& lent) {
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
      const json* indices = member(primitive, "indices");
      json* accessor = indices == nullptr ? nullptr : entry(file, "accessors", *indices);
      if (accessor == nullptr || accessor->contains("bufferView")) return;
      if (file["bufferViews"].empty()) file["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
      (*accessor)["bufferView"] = 0;
      lent.push_back(indices->get<std::size_t>());
      changed = true;
    });
  });
  return changed;
}

}  // namespace traces::gltf
