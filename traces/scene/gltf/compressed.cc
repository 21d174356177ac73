#include "traces/scene/gltf/compressed.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/context.h"

namespace traces::gltf {
namespace {

/// A Draco decoder that checks the memory budget at the two places where the data determine an allocation.
template <class Base>
class Bounded : public Base {
 public:
  explicit Bounded(Budget& budget) : budget_(budget) {}

 protected:
  bool DecodeConnectivity() override {
    constexpr std::uint64_t kFaceBytes = 128, kPointBytes = 64;  // corner table and temporaries of the decoder
    draco::DecoderBuffer ahead = *this->buffer();
    // Edgebreaker stores vertices, then faces; sequential coding stores faces, then points.
    std::uint32_t first = 0, second = 0;
    if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
    constexpr bool kFacesFirst = std::is_same_v<Base, draco::MeshSequentialDecoder>;
    budget_.take_memory(kFacesFirst ? first : second, kFaceBytes, "the faces of Draco data");
    budget_.take_memory(kFacesFirst ? second : first, kPointBytes, "the points of Draco data");
    return Base::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    const draco::PointCloud& points = *this->point_cloud();
    for (int i = 0; i < points.num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *points.attribute(i);
      const auto each = static_cast<std::uint64_t>(attribute.byte_stride()) + 8U * attribute.num_components() + 8;
      budget_.take_memory(points.num_points(), each, "the attributes of Draco data");
    }
    return Base::DecodeAllAttributes();
  }

 private:
  Budget& budget_;
};

template <class Base>
bool decode_draco_with(Budget& budget, const Bytes& bytes, draco::Mesh& mesh) {
  const draco::DecoderOptions options;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data), bytes.size);
  Bounded<Base> decoder(budget);
  return decoder.Decode(options, &buffer, &mesh).ok();
}

/// Decodes a Draco mesh. Returns an error text, or null on success.
const char* decode_mesh(Budget& budget, const Bytes& bytes, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data), bytes.size);
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return "no Draco data";
  if (header.version_major != 2 || header.version_minor != 2) return "not of Draco bitstream version 2.2";
  if (header.encoder_type != draco::TRIANGULAR_MESH) return "no mesh";
  const bool good = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING
                        ? decode_draco_with<draco::MeshEdgebreakerDecoder>(budget, bytes, mesh)
                        : decode_draco_with<draco::MeshSequentialDecoder>(budget, bytes, mesh);
  return good ? nullptr : "damaged Draco data";
}

/// Returns an accessor without sparse elements. Sets the fields for them, which tinygltf leaves uninitialised.
tinygltf::Accessor dense_accessor(int component_type, int type, std::size_t count) {
  tinygltf::Accessor accessor;
  accessor.sparse = {};
  accessor.componentType = component_type;
  accessor.type = type;
  accessor.count = count;
  return accessor;
}

/// Appends bytes to the glTF model as a buffer with a view and an accessor. Returns the accessor's index.
int add_accessor(tinygltf::Model& model, std::vector<unsigned char> bytes, tinygltf::Accessor accessor) {
  tinygltf::BufferView view;
  view.buffer = static_cast<int>(model.buffers.size());
  view.byteLength = bytes.size();
  model.buffers.emplace_back().data = std::move(bytes);
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  accessor.byteOffset = 0;
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size()) - 1;
}

int add_indices(Context& context, tinygltf::Model& model, const draco::Mesh& mesh) {
  context.budget.take_memory(mesh.num_faces(), 3 * sizeof(std::uint32_t), "Draco indices");
  std::vector<unsigned char> bytes(std::size_t{mesh.num_faces()} * 3 * sizeof(std::uint32_t));
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
    const std::uint32_t corners[3] = {face[0].value(), face[1].value(), face[2].value()};
    std::memcpy(&bytes[i * sizeof corners], corners, sizeof corners);
  }
  return add_accessor(
      model, std::move(bytes),
      dense_accessor(TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, std::size_t{mesh.num_faces()} * 3));
}

/// Appends a value to `bytes` as component type T. Returns false if T cannot represent the value.
template <class T>
bool append_value(double value, std::vector<unsigned char>& bytes) {
  if constexpr (std::is_integral_v<T>) {
    value = std::round(value);
    if (!(value >= std::numeric_limits<T>::lowest() && value <= std::numeric_limits<T>::max())) return false;
  }
  const auto converted = static_cast<T>(value);
  const auto* first = reinterpret_cast<const unsigned char*>(&converted);
  bytes.insert(bytes.end(), first, first + sizeof converted);
  return true;
}

bool append_value(double value, int component_type, bool normalised, std::vector<unsigned char>& bytes) {
  const auto scaled = [&](double most) { return normalised ? value * most : value; };
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return append_value<std::int8_t>(scaled(127), bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return append_value<std::uint8_t>(scaled(255), bytes);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return append_value<std::int16_t>(scaled(32767), bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return append_value<std::uint16_t>(scaled(65535), bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return append_value<std::uint32_t>(scaled(4294967295), bytes);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return append_value<float>(value, bytes);
    default:
      return false;
  }
}

/// Adds an accessor with the values of a Draco attribute, converted to the component type that the file declares.
int add_attribute(Context& context, tinygltf::Model& model, const draco::PointAttribute& attribute,
                  std::uint32_t points, const tinygltf::Accessor& declared, const std::string& what) {
  const int components = attribute.num_components();
  if (components < 1 || components > 4) context.refuse(what + " is of a type that glTF does not have");
  tinygltf::Accessor accessor =
      dense_accessor(declared.componentType, components == 1 ? TINYGLTF_TYPE_SCALAR : components, points);
  accessor.normalized = declared.normalized;
  const auto count = static_cast<std::size_t>(components);
  context.budget.take_memory(points, count * sizeof(float), what);
  std::vector<unsigned char> bytes;
  bytes.reserve(points * count * sizeof(float));
  const bool mapped = !attribute.is_mapping_identity();
  if (mapped && attribute.indices_map_size() < points) context.refuse(what + " has too few values");
  for (std::uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(i));
    if (at.value() >= attribute.size()) context.refuse(what + " has too few values");
    std::array<double, 4> values{};
    const bool known = attribute.ConvertValue(at, static_cast<std::int8_t>(components), values.data());
    for (std::size_t k = 0; k < count; ++k) {
      if (!known || !append_value(values[k], declared.componentType, attribute.normalized(), bytes)) {
        context.refuse(fmt::format("{}: value {} does not fit component type {}", what, i, declared.componentType));
      }
    }
  }
  return add_accessor(model, std::move(bytes), std::move(accessor));
}

void expand_primitive(Context& context, tinygltf::Model& model, tinygltf::Primitive& primitive,
                      const tinygltf::Value& extension, const std::string& what) {
  const Bytes bytes = view_bytes(context, index_or_none(extension, "bufferView"));
  draco::Mesh mesh;
  if (const char* fault = decode_mesh(context.budget, bytes, mesh)) context.refuse(what + ": " + fault);
  primitive.indices = add_indices(context, model, mesh);
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  if (!extension.Has("attributes") || !extension.Get("attributes").IsObject()) return;
  const tinygltf::Value& attributes = extension.Get("attributes");
  for (const std::string& name : attributes.Keys()) {
    const auto declared = primitive.attributes.find(name);
    if (declared == primitive.attributes.end()) continue;
    const std::string shown = fmt::format("{}: the Draco attribute {}", what, sim::printable(name));
    const int id = index_or_none(attributes, name.c_str());
    const draco::PointAttribute* found = id < 0 ? nullptr : mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
    if (found == nullptr) context.refuse(shown + " is missing");
    const tinygltf::Accessor accessor = context.at(model.accessors, declared->second, "accessors");
    declared->second = add_attribute(context, model, *found, mesh.num_points(), accessor, shown);
  }
}

}  // namespace

void expand_draco(Context& context, tinygltf::Model& model) {
  for (std::size_t m = 0; m < model.meshes.size(); ++m) {
    std::vector<tinygltf::Primitive>& primitives = model.meshes[m].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto* extension = find_extension(primitives[p].extensions, "KHR_draco_mesh_compression");
      if (extension != nullptr)
        expand_primitive(context, model, primitives[p], *extension, fmt::format("meshes[{}].primitives[{}]", m, p));
    }
  }
}

namespace {

std::string text_or(const tinygltf::Value& object, const char* key, const char* absent) {
  return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : absent;
}

/// Checks conditions that the meshopt decoder requires but does not check. Returns an error text, or null.
const char* meshopt_fault(const std::string& mode, const std::string& filter, std::size_t count, std::size_t stride) {
  const bool attributes = mode == "ATTRIBUTES";
  if (!attributes && mode != "TRIANGLES" && mode != "INDICES") return "the mode is unknown";
  if (attributes && (stride == 0 || stride > 256 || stride % 4 != 0)) return "the stride is not one of 4, 8 .. 256";
  if (!attributes && stride != 2 && stride != 4) return "the stride of indices is not 2 or 4";
  if (mode == "TRIANGLES" && count % 3 != 0) return "the number of indices is not a multiple of 3";
  if (filter == "NONE") return nullptr;
  if (!attributes) return "indices take no filter";
  if (filter == "OCTAHEDRAL") return stride == 4 || stride == 8 ? nullptr : "the filter needs a stride of 4 or 8";
  if (filter == "QUATERNION") return stride == 8 ? nullptr : "the filter needs a stride of 8";
  return filter == "EXPONENTIAL" ? nullptr : "the filter is unknown";
}

std::vector<unsigned char> decode_view(Context& context, const tinygltf::Value& extension, const std::string& what) {
  const int index = index_or_none(extension, "buffer");
  const std::vector<unsigned char>& buffer = context.at(context.model.buffers, index, "buffers").data;
  const std::uint64_t offset = count_or(context, extension, "byteOffset", 0);
  const std::uint64_t size = count_or(context, extension, "byteLength", 0);
  const std::uint64_t count = count_or(context, extension, "count", 0);
  const std::uint64_t stride = count_or(context, extension, "byteStride", 0);
  const std::string mode = text_or(extension, "mode", ""), filter = text_or(extension, "filter", "NONE");
  if (offset > buffer.size() || size > buffer.size() - offset) context.refuse(what + " leaves its buffer");
  if (const char* fault = meshopt_fault(mode, filter, count, stride)) {
    context.refuse(fmt::format("{}: {} (mode '{}', filter '{}', stride {}, count {})", what, fault,
                               sim::printable(mode), sim::printable(filter), stride, count));
  }
  context.budget.take_memory(count, stride, what);
  std::vector<unsigned char> out(count * stride);
  const unsigned char* from = buffer.data() + offset;
  const int failed = mode == "ATTRIBUTES"  ? meshopt_decodeVertexBuffer(out.data(), count, stride, from, size)
                     : mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(out.data(), count, stride, from, size)
                                           : meshopt_decodeIndexSequence(out.data(), count, stride, from, size);
  if (failed != 0) context.refuse(what + ": damaged, or of a later version than is supported");
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
  return out;
}

}  // namespace

void expand_meshopt(Context& context, tinygltf::Model& model) {
  for (std::size_t i = 0; i < model.bufferViews.size(); ++i) {
    tinygltf::BufferView& view = model.bufferViews[i];
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      const auto* extension = find_extension(view.extensions, name);
      if (extension == nullptr) continue;
      std::vector<unsigned char> bytes = decode_view(context, *extension, fmt::format("bufferViews[{}] ({})", i, name));
      view.buffer = static_cast<int>(model.buffers.size());
      view.byteOffset = 0;
      view.byteLength = bytes.size();
      model.buffers.emplace_back().data = std::move(bytes);
      break;
    }
  }
}

}  // namespace traces::gltf
