#include "traces/scene/gltf/parse.h"

#include <cstdint>
#include <exception>
#include <utility>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace traces::gltf {
namespace {

using sim::Json;

Json* find_member(Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

Json* find_extension_json(Json& object, const char* name) {
  Json* extensions = find_member(object, "extensions");
  return extensions == nullptr ? nullptr : find_member(*extensions, name);
}

/// Calls visit(entry) for each entry of the JSON list `object[key]`, if it is a list.
template <class Visit>
void for_each_entry(Json& object, const char* key, Visit visit) {
  Json* list = find_member(object, key);
  if (list == nullptr || !list->is_array()) return;
  for (Json& entry : *list) visit(entry);
}

/// Returns the JSON value `object[key][index]`, or null if there is no such entry.
Json* find_entry(Json& object, const char* key, const Json& index) {
  Json* list = find_member(object, key);
  if (list == nullptr || !list->is_array() || !index.is_number_unsigned()) return nullptr;
  const auto at = index.get<std::uint64_t>();
  return at < list->size() ? &(*list)[at] : nullptr;
}

}  // namespace

bool make_parsable(Json& file, std::vector<std::size_t>& lent) {
  bool changed = false;
  for_each_entry(file, "buffers", [&](Json& buffer) {
    if (find_extension_json(buffer, "EXT_meshopt_compression") == nullptr &&
        find_extension_json(buffer, "KHR_meshopt_compression") == nullptr) {
      return;
    }
    if (find_member(buffer, "uri") != nullptr) return;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    buffer["byteLength"] = 1;
    changed = true;
  });
  for_each_entry(file, "meshes", [&](Json& mesh) {
    for_each_entry(mesh, "primitives", [&](Json& primitive) {
      const Json* indices = find_member(primitive, "indices");
      Json* accessor = indices == nullptr ? nullptr : find_entry(file, "accessors", *indices);
      if (accessor == nullptr || accessor->contains("bufferView")) return;
      if (file["bufferViews"].empty()) file["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
      (*accessor)["bufferView"] = 0;
      lent.push_back(indices->get<std::size_t>());
      changed = true;
    });
  });
  return changed;
}

namespace {

bool store_encoded_image(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                         const unsigned char* bytes, int size, void*) {
  // The bytes of a buffer view are not read here, because tinygltf has not checked that they exist.
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  return true;
}

const Source& source_of(void* user) { return *static_cast<const Source*>(user); }

/// Sets the callback for file sizes, which tinygltf has since version 2.9.
template <class Callbacks>
void set_size_callback(Callbacks& fs) {
  if constexpr (requires { fs.GetFileSizeInBytes; }) {
    fs.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string& name, void* user) {
      *size = source_of(user).external.at(name).size();
      return true;
    };
  }
}

/// Returns callbacks that read the source's bytes. All of them are set, because newer releases access the file system
/// if one is missing.
tinygltf::FsCallbacks file_callbacks(const Source& source) {
  tinygltf::FsCallbacks fs{};
  fs.user_data = const_cast<Source*>(&source);
  fs.FileExists = [](const std::string& name, void* user) { return source_of(user).external.contains(name); };
  fs.ExpandFilePath = [](const std::string& name, void*) { return name; };
  fs.ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& name, void* user) {
    const std::string& bytes = source_of(user).external.at(name);
    out->assign(bytes.begin(), bytes.end());
    return true;
  };
  fs.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; };
  set_size_callback(fs);
  return fs;
}

/// Returns the last line of tinygltf's messages, which is the fatal error.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return sim::printable(text.substr(text.rfind('\n') + 1));  // npos + 1 is 0
}

}  // namespace

tinygltf::Model parse_model(const Source& source) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(store_encoded_image, nullptr);
  loader.SetFsCallbacks(file_callbacks(source));
  tinygltf::Model model;
  std::string error, ignored;
  bool good = false;
  const auto size = static_cast<unsigned>(source.bytes.size());
  try {
    if (source.binary) {
      const auto* bytes = reinterpret_cast<const unsigned char*>(source.bytes.data());
      good = loader.LoadBinaryFromMemory(&model, &error, &ignored, bytes, size);
    } else {
      good = loader.LoadASCIIFromString(&model, &error, &ignored, source.bytes.data(), size, "");
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& caught) {
    error = caught.what();
  }
  if (!good) throw sim::InputError(source.shown_name + ": not a glTF 2.0 file: " + last_line(error));
  if (!model.asset.version.starts_with("2.")) {
    throw sim::InputError(source.shown_name + ": glTF version '" + sim::printable(model.asset.version) +
                          "'; supported is 2.0");
  }
  for (const std::size_t accessor : source.lent) model.accessors[accessor].bufferView = -1;
  return model;
}

}  // namespace traces::gltf
