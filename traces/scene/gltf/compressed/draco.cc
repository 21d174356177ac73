#include "traces/scene/gltf/compressed/draco.h"

#include <cstring>
#include <memory>

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <fmt/format.h>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

/// A decoder of Draco's that asks the budget at the two places where the data decide how much memory is taken.
template <class Base>
class Bounded : public Base {
 public:
  explicit Bounded(Budget& budget) : budget_(budget) {}

 protected:
  bool DecodeConnectivity() override {
    constexpr std::uint64_t kFaceBytes = 128, kPointBytes = 64;  // corner table and what is made while decoding
    draco::DecoderBuffer ahead = *this->buffer();
    // Edgebreaker: vertices, faces. Sequential: faces, points.
    std::uint32_t first = 0, second = 0;
    if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
    constexpr bool kFacesFirst = std::is_same_v<Base, draco::MeshSequentialDecoder>;
    budget_.take(kFacesFirst ? first : second, kFaceBytes, "the faces of Draco data");
    budget_.take(kFacesFirst ? second : first, kPointBytes, "the points of Draco data");
    return Base::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    const draco::PointCloud& points = *this->point_cloud();
    for (int i = 0; i < points.num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *points.attribute(i);
      const auto each = static_cast<std::uint64_t>(attribute.byte_stride()) + 8U * attribute.num_components() + 8;
      budget_.take(points.num_points(), each, "the attributes of Draco data");
    }
    return Base::DecodeAllAttributes();
  }

 private:
  Budget& budget_;
};

template <class Base>
bool decode_with(Budget& budget, const Bytes& bytes, draco::Mesh& mesh) {
  const draco::DecoderOptions options;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data), bytes.size);
  Bounded<Base> decoder(budget);
  return decoder.Decode(options, &buffer, &mesh).ok();
}

/// Nothing, or what is wrong with the data.
const char* decode(Budget& budget, const Bytes& bytes, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data), bytes.size);
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return "no Draco data";
  if (header.version_major != 2 || header.version_minor != 2) return "not of Draco bitstream version 2.2";
  if (header.encoder_type != draco::TRIANGULAR_MESH) return "no mesh";
  const bool good = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING
                        ? decode_with<draco::MeshEdgebreakerDecoder>(budget, bytes, mesh)
                        : decode_with<draco::MeshSequentialDecoder>(budget, bytes, mesh);
  return good ? nullptr : "damaged Draco data";
}

/// glTF's number for the type, 0 where glTF has none.
int component_type(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16:
      return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_UINT32:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32:
      return TINYGLTF_COMPONENT_TYPE_FLOAT;
    default:
      return 0;
  }
}

/// An accessor of values that are all stored; tinygltf leaves the numbers of sparse ones unset.
tinygltf::Accessor dense_accessor(int component_type, int type, std::size_t count) {
  tinygltf::Accessor accessor;
  accessor.sparse = {};
  accessor.componentType = component_type;
  accessor.type = type;
  accessor.count = count;
  return accessor;
}

/// Appends the bytes to the model as a buffer with a view and an accessor; returns the accessor's index.
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
  context.budget.take(mesh.num_faces(), 3 * sizeof(std::uint32_t), "Draco indices");
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

int add_attribute(Context& context, tinygltf::Model& model, const draco::PointAttribute& attribute,
                  std::uint32_t points, bool normalised, const std::string& what) {
  const int of_each = component_type(attribute.data_type()), components = attribute.num_components();
  if (of_each == 0 || components < 1 || components > 4) {
    context.refuse(what + " is of a type that glTF does not have");
  }
  tinygltf::Accessor accessor = dense_accessor(of_each, components == 1 ? TINYGLTF_TYPE_SCALAR : components, points);
  accessor.normalized = normalised;
  const auto stride = static_cast<std::size_t>(attribute.byte_stride());
  context.budget.take(points, stride, what);
  std::vector<unsigned char> bytes(points * stride);
  const bool mapped = !attribute.is_mapping_identity();
  if (mapped && attribute.indices_map_size() < points) context.refuse(what + " has too few values");
  for (std::uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(i));
    if (at.value() >= attribute.size()) context.refuse(what + " has too few values");
    attribute.GetValue(at, &bytes[i * stride]);
  }
  return add_accessor(model, std::move(bytes), std::move(accessor));
}

void expand(Context& context, tinygltf::Model& model, tinygltf::Primitive& primitive, const tinygltf::Value& extension,
            const std::string& what) {
  const Bytes bytes = view_bytes(context, index_or_none(extension, "bufferView"));
  draco::Mesh mesh;
  if (const char* fault = decode(context.budget, bytes, mesh)) context.refuse(what + ": " + fault);
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
    const bool normalised = context.at(model.accessors, declared->second, "accessors").normalized;
    declared->second = add_attribute(context, model, *found, mesh.num_points(), normalised, shown);
  }
}

}  // namespace

void expand_draco(Context& context, tinygltf::Model& model) {
  for (std::size_t m = 0; m < model.meshes.size(); ++m) {
    std::vector<tinygltf::Primitive>& primitives = model.meshes[m].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto* extension = find_extension(primitives[p].extensions, "KHR_draco_mesh_compression");
      if (extension != nullptr)
        expand(context, model, primitives[p], *extension, fmt::format("meshes[{}].primitives[{}]", m, p));
    }
  }
}

}  // namespace traces::gltf
