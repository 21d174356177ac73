#include "traces/scene/gltf_export/document.h"

#include <algorithm>
#include <limits>
#include <sstream>

#include "sim/error.h"
#include "sim/io/json.h"
#include "traces/scene/glb.h"

namespace traces::gltf_export {
namespace {

/// Replaces JSON nulls by empty objects: tinygltf writes an object without members, such as an empty node, as null.
bool replace_nulls(sim::Json& value) {
  bool changed = value.is_null();
  if (changed) value = sim::Json::object();
  if (value.is_structured()) {
    for (sim::Json& member : value) changed |= replace_nulls(member);
  }
  return changed;
}

}  // namespace

int Document::add_view(std::span<const std::byte> bytes, Use use) {
  buffer_.resize((buffer_.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = buffer_.size();
  view.byteLength = bytes.size();
  view.target = use == Use::kVertices  ? TINYGLTF_TARGET_ARRAY_BUFFER
                : use == Use::kIndices ? TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER
                                       : 0;
  const auto* first = reinterpret_cast<const unsigned char*>(bytes.data());
  buffer_.insert(buffer_.end(), first, first + bytes.size());
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int Document::add_accessor(std::span<const std::byte> bytes, int component, int type, std::size_t count, Use use) {
  tinygltf::Accessor accessor;
  accessor.bufferView = add_view(bytes, use);
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

int Document::add_array(std::span<const float> values, bool bounds) {
  const int index = add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR,
                                 values.size(), Use::kOther);
  if (!bounds) return index;
  const auto [least, most] = std::ranges::minmax(values);
  model.accessors.back().minValues = {static_cast<double>(least)};
  model.accessors.back().maxValues = {static_cast<double>(most)};
  return index;
}

int Document::add_array(std::span<const glm::vec2> values) {
  return add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, values.size(),
                      Use::kVertices);
}

int Document::add_array(std::span<const glm::vec3> values, bool bounds, Use use) {
  const int index =
      add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, values.size(), use);
  if (bounds) {
    glm::vec3 least = values.front(), most = values.front();
    for (const glm::vec3& v : values) least = glm::min(least, v), most = glm::max(most, v);
    model.accessors.back().minValues = to_numbers(least);
    model.accessors.back().maxValues = to_numbers(most);
  }
  return index;
}

int Document::add_array(std::span<const glm::vec4> values, Use use) {
  return add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, values.size(), use);
}

int Document::add_array(std::span<const glm::mat4> values) {
  return add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4, values.size(),
                      Use::kOther);
}

int Document::add_array(std::span<const std::array<std::uint16_t, 4>> values) {
  return add_accessor(std::as_bytes(values), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, values.size(),
                      Use::kVertices);
}

int Document::add_array(std::span<const std::array<std::uint32_t, 3>> triangles, bool wide) {
  const std::size_t count = triangles.size() * 3;
  if (wide) {
    return add_accessor(std::as_bytes(triangles), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, count,
                        Use::kIndices);
  }
  std::vector<std::uint16_t> narrow;
  narrow.reserve(count);
  for (const auto& corners : triangles) {
    for (const std::uint32_t vertex : corners) narrow.push_back(static_cast<std::uint16_t>(vertex));
  }
  return add_accessor(std::as_bytes(std::span(narrow)), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_SCALAR,
                      count, Use::kIndices);
}

void Document::add_extension(tinygltf::ExtensionMap& extensions, const char* name, tinygltf::Value::Object object) {
  extensions[name] = tinygltf::Value(std::move(object));
  used_.insert(name);
}

std::string Document::glb_bytes() && {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() / 8 * 7;  // leaves room for the JSON
  if (buffer_.size() > kMost) throw sim::InputError("the scene is too large for a GLB file: it holds at most 4 GiB");
  if (!buffer_.empty()) model.buffers.emplace_back().data = std::move(buffer_);
  model.extensionsUsed.assign(used_.begin(), used_.end());
  std::ostringstream out;
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, out, false, true);
  std::string glb = std::move(out).str();
  auto json = sim::parse_json(glb_json(glb));
  if (replace_nulls(json)) set_glb_json(glb, sim::json_line(json));
  return glb;
}

std::vector<double> to_numbers(const glm::vec3& v) { return {double{v.x}, double{v.y}, double{v.z}}; }
std::vector<double> to_numbers(const glm::vec4& v) { return {double{v.x}, double{v.y}, double{v.z}, double{v.w}}; }

tinygltf::Value to_value(float number) { return tinygltf::Value(static_cast<double>(number)); }

tinygltf::Value to_value(const glm::vec3& v) {
  return tinygltf::Value(tinygltf::Value::Array{to_value(v.x), to_value(v.y), to_value(v.z)});
}

}  // namespace traces::gltf_export
