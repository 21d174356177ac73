#include "traces/scene/gltf/accessors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

namespace traces::gltf {
namespace {

/// Where an accessor's elements of `size` bytes are: one every `stride` bytes, all inside their buffer view.
struct Elements {
  const std::uint8_t* data = nullptr;
  std::size_t stride = 0;
  const std::uint8_t* element_bytes(std::size_t i) const { return data + i * stride; }
};

Elements view_elements(const Context& context, int buffer_view, std::size_t offset, std::size_t count, std::size_t size,
                       const std::string& what) {
  const Bytes bytes = view_bytes(context, buffer_view);
  const std::size_t given = context.model.bufferViews[static_cast<std::size_t>(buffer_view)].byteStride;
  const std::size_t stride = given == 0 ? size : given;
  if (stride < size)
    context.refuse(fmt::format("{}: stride {} is less than an element's {} bytes", what, stride, size));
  if (offset > bytes.size || bytes.size - offset < size || (count - 1) > (bytes.size - offset - size) / stride) {
    context.refuse(fmt::format("{}: {} elements of {} bytes from byte {} leave buffer view {} of {} bytes", what, count,
                               size, offset, buffer_view, bytes.size));
  }
  return {bytes.data + offset, stride};
}

template <class T>
T load_value(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

std::size_t component_size(const Context& context, int type, const std::string& what) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      context.refuse(fmt::format("{}: component type {} is not one of 5120 to 5123, 5125, 5126", what, type));
  }
}

float load_float(const std::uint8_t* from, int type, bool normalised) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float v = load_value<std::int8_t>(from);
      return normalised ? std::max(v / 127, -1.0F) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const float v = load_value<std::uint8_t>(from);
      return normalised ? v / 255 : v;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float v = load_value<std::int16_t>(from);
      return normalised ? std::max(v / 32767, -1.0F) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const float v = load_value<std::uint16_t>(from);
      return normalised ? v / 65535 : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<float>(load_value<std::uint32_t>(from));
    default:
      return load_value<float>(from);
  }
}

std::uint32_t load_index(const std::uint8_t* from, std::size_t size) {
  return size == 1   ? load_value<std::uint8_t>(from)
         : size == 2 ? load_value<std::uint16_t>(from)
                     : load_value<std::uint32_t>(from);
}

bool is_unsigned(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

/// Calls put(index, bytes) for each dense element of an accessor, then for each element that its sparse data replace.
template <class Put>
void for_each_element(const Context& context, const tinygltf::Accessor& accessor, std::size_t size,
                      const std::string& what, Put put) {
  if (accessor.bufferView >= 0) {
    const Elements dense = view_elements(context, accessor.bufferView, accessor.byteOffset, accessor.count, size, what);
    for (std::size_t i = 0; i < accessor.count; ++i) put(i, dense.element_bytes(i));
  }
  if (!accessor.sparse.isSparse) return;
  const auto& sparse = accessor.sparse;
  if (sparse.count < 1 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 ||
      !is_unsigned(sparse.indices.componentType)) {
    context.refuse(what + ": the sparse part is not valid");
  }
  const auto count = static_cast<std::size_t>(sparse.count);
  const std::size_t index_size = component_size(context, sparse.indices.componentType, what);
  const Elements indices = view_elements(context, sparse.indices.bufferView,
                                         static_cast<std::size_t>(sparse.indices.byteOffset), count, index_size, what);
  const Elements values = view_elements(context, sparse.values.bufferView,
                                        static_cast<std::size_t>(sparse.values.byteOffset), count, size, what);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t at = load_index(indices.element_bytes(i), index_size);
    if (at >= accessor.count)
      context.refuse(fmt::format("{}: sparse index {} of {} elements", what, at, accessor.count));
    put(at, values.element_bytes(i));
  }
}

/// Largest number of elements of an accessor without bytes in the file; such elements are zero.
constexpr std::size_t kMostZeros = 1 << 20;

/// Returns an accessor after checking its bounds. Subtracts the accessor's decoded size from the memory budget.
const tinygltf::Accessor& find_accessor(Context& context, int index, int type, std::size_t bytes_each,
                                        const std::string& what) {
  const tinygltf::Accessor& accessor = context.at(context.model.accessors, index, "accessors");
  if (accessor.type != type) context.refuse(what + " has the wrong type (scalar, vector or matrix)");
  if (accessor.count == 0) context.refuse(what + " is empty");
  const std::size_t size = component_size(context, accessor.componentType, what) *
                           static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  if (accessor.bufferView >= 0) {
    view_elements(context, accessor.bufferView, accessor.byteOffset, accessor.count, size, what);
  } else if (accessor.count > kMostZeros) {
    context.refuse(
        fmt::format("{} has {} elements without a buffer view; allowed: {}", what, accessor.count, kMostZeros));
  }
  context.budget.take_memory(accessor.count, bytes_each, what);
  return accessor;
}

template <class Vector>
std::vector<Vector> read_elements(Context& context, int index, int type, const char* name) {
  const std::string what = fmt::format("accessors[{}] ({})", index, name);
  const tinygltf::Accessor& accessor = find_accessor(context, index, type, sizeof(Vector), what);
  const std::size_t size = component_size(context, accessor.componentType, what);
  constexpr int kComponents = Vector::length();
  std::vector<Vector> out(accessor.count, Vector(0));
  for_each_element(context, accessor, size * kComponents, what, [&](std::size_t i, const std::uint8_t* from) {
    for (int k = 0; k < kComponents; ++k) {
      const float value =
          load_float(from + static_cast<std::size_t>(k) * size, accessor.componentType, accessor.normalized);
      if (!std::isfinite(value)) context.refuse(fmt::format("{}: element {} is not a finite number", what, i));
      out[i][k] = value;
    }
  });
  return out;
}

/// A fixed number of floats, with the interface of a vector.
template <int kCount>
struct Numbers {
  std::array<float, kCount> values;
  explicit Numbers(int value) { values.fill(static_cast<float>(value)); }
  static constexpr int length() { return kCount; }
  float& operator[](int i) { return values[static_cast<std::size_t>(i)]; }
};

}  // namespace

Bytes view_bytes(const Context& context, int buffer_view) {
  const tinygltf::BufferView& view = context.at(context.model.bufferViews, buffer_view, "bufferViews");
  const tinygltf::Buffer& buffer = context.at(context.model.buffers, view.buffer, "buffers");
  if (view.byteOffset > buffer.data.size() || view.byteLength > buffer.data.size() - view.byteOffset) {
    context.refuse(fmt::format("bufferViews[{}]: {} bytes from byte {} leave their buffer of {} bytes", buffer_view,
                               view.byteLength, view.byteOffset, buffer.data.size()));
  }
  return {buffer.data.data() + view.byteOffset, view.byteLength};
}

std::vector<float> read_floats(Context& context, int accessor, const char* what) {
  std::vector<float> out;
  for (const auto& v : read_elements<Numbers<1>>(context, accessor, TINYGLTF_TYPE_SCALAR, what))
    out.push_back(v.values[0]);
  return out;
}

std::vector<glm::vec2> read_vec2(Context& context, int accessor, const char* what) {
  return read_elements<glm::vec2>(context, accessor, TINYGLTF_TYPE_VEC2, what);
}

std::vector<glm::vec3> read_vec3(Context& context, int accessor, const char* what) {
  return read_elements<glm::vec3>(context, accessor, TINYGLTF_TYPE_VEC3, what);
}

std::vector<glm::vec4> read_vec4(Context& context, int accessor, const char* what) {
  return read_elements<glm::vec4>(context, accessor, TINYGLTF_TYPE_VEC4, what);
}

std::vector<glm::mat4> read_mat4(Context& context, int accessor, const char* what) {
  if (context.at(context.model.accessors, accessor, "accessors").componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
    context.refuse(fmt::format("accessors[{}] ({}) must be of single precision", accessor, what));
  }
  std::vector<glm::mat4> out;
  for (const auto& v : read_elements<Numbers<16>>(context, accessor, TINYGLTF_TYPE_MAT4, what)) {
    out.push_back(glm::make_mat4(v.values.data()));
  }
  return out;
}

std::vector<std::uint32_t> read_indices(Context& context, int index) {
  const std::string what = fmt::format("accessors[{}] (indices)", index);
  const tinygltf::Accessor& accessor = find_accessor(context, index, TINYGLTF_TYPE_SCALAR, sizeof(std::uint32_t), what);
  if (!is_unsigned(accessor.componentType)) {
    context.refuse(fmt::format("{}: component type {} is not one of 5121, 5123, 5125", what, accessor.componentType));
  }
  const std::size_t size = component_size(context, accessor.componentType, what);
  std::vector<std::uint32_t> out(accessor.count, 0);
  for_each_element(context, accessor, size, what,
                   [&](std::size_t i, const std::uint8_t* from) { out[i] = load_index(from, size); });
  return out;
}

}  // namespace traces::gltf
