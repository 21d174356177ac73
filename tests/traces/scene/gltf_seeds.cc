#include "tests/traces/scene/gltf_seeds.h"

#include <draco/compression/expert_encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "traces/scene/images.h"

namespace test {
namespace {

using nlohmann::json;

/// Returns the tiny file without its triangle.
TinyGltf empty_file() {
  TinyGltf file;
  file.binary.clear();
  file.json["bufferViews"] = json::array();
  file.json["accessors"] = json::array();
  return file;
}

std::string draco_bytes(const Patch& patch, bool edgebreaker, std::size_t& points) {
  draco::TriangleSoupMeshBuilder builder;
  const std::size_t faces = patch.indices.size() / 3;
  builder.Start(static_cast<int>(faces));
  const auto add = [&](draco::GeometryAttribute::Type type, int components, const std::vector<float>& values) {
    const int id = builder.AddAttribute(type, static_cast<std::int8_t>(components), draco::DT_FLOAT32);
    for (std::size_t f = 0; f < faces; ++f) {
      const float* corner[3];
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = &values[patch.indices[3 * f + k] * static_cast<std::size_t>(components)];
      }
      builder.SetAttributeValuesForFace(id, draco::FaceIndex(static_cast<std::uint32_t>(f)), corner[0], corner[1],
                                        corner[2]);
    }
    return id;
  };
  const int positions = add(draco::GeometryAttribute::POSITION, 3, patch.positions);
  const int normals = add(draco::GeometryAttribute::NORMAL, 3, patch.normals);
  const int uvs = add(draco::GeometryAttribute::TEX_COORD, 2, patch.uvs);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::ExpertEncoder encoder(*mesh);
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(positions, 14);
  encoder.SetAttributeQuantization(normals, 10);
  encoder.SetAttributeQuantization(uvs, 12);
  draco::EncoderBuffer out;
  EXPECT_TRUE(encoder.EncodeToBuffer(&out).ok());
  points = mesh->num_points();
  return {out.data(), out.size()};
}

json declared(int component_type, const char* type, std::size_t count) {
  return {{"componentType", component_type}, {"type", type}, {"count", count}};
}

TinyGltf skinned_and_animated() {
  TinyGltf file;
  json& attributes = file.primitive()["attributes"];
  attributes["JOINTS_0"] = file.add<std::uint8_t>(std::vector<std::uint8_t>(12, 0), kUByte, "VEC4", 3);
  attributes["WEIGHTS_0"] = file.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4", 3);
  file.primitive()["targets"] = {{{"POSITION", file.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, kFloat, "VEC3", 3)}}};
  file.json["meshes"][0]["weights"] = {0.5};
  const int bind = file.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, kFloat, "MAT4", 1);
  const int times = file.add<float>({0, 1}, kFloat, "SCALAR", 2);
  const int moves = file.add<float>({0, 0, 0, 1, 0, 0}, kFloat, "VEC3", 2);
  const int weights = file.add<float>({0, 1}, kFloat, "SCALAR", 2);
  file.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"name", "bone"}}};
  file.json["scenes"][0]["nodes"] = {0, 1};
  file.json["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", bind}}};
  file.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", moves}}, {{"input", times}, {"output", weights}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}},
         {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
  return file;
}

TinyGltf sparse_strip() {
  TinyGltf file;
  const int at = file.add_view(std::string("\x01", 1));
  const float moved[3] = {2, 0, 0};
  const int value = file.add_view(std::string(reinterpret_cast<const char*>(moved), sizeof moved));
  file.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", at}, {"componentType", kUByte}}}, {"values", {{"bufferView", value}}}};
  file.primitive()["mode"] = 5;
  file.primitive()["attributes"]["COLOR_0"] =
      file.add<std::uint8_t>({255, 0, 0, 255, 9, 9, 9, 9, 1, 2, 3, 4}, kUByte, "VEC4", 3, true);
  return file;
}

TinyGltf textured_seed() {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 2, 2, std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255, 1, 2, 3, 4, 5, 6});
  TinyGltf file;
  file.json["images"] = {
      {{"bufferView", file.add_view(read_bytes(folder.path() / "a.png"))}, {"mimeType", "image/png"}}};
  file.json["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  file.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add<float>({0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 3);
  json& m = file.material();
  m["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}};
  m["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  m["occlusionTexture"] = {{"index", 0},
                           {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"rotation", 1}}}}}};
  m["emissiveTexture"] = {{"index", 0}};
  m["emissiveFactor"] = {1, 1, 1};
  m["alphaMode"] = "MASK";
  m["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
                     {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 2}}},
                     {"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}};
  return file;
}

TinyGltf lights_and_cameras() {
  TinyGltf file;
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"range", 9}, {"spot", {{"outerConeAngle", 0.5}}}}};
  const int translations = file.add<float>({1, 0, 0, 0, 3, 0}, kFloat, "VEC3", 2);
  file.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translations}};
  file.node()["children"] = {1};
  file.node()["rotation"] = {0, 0, 0, 1};
  file.json["nodes"].push_back(
      {{"camera", 0}, {"translation", {0, 0, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return file;
}

}  // namespace

Patch make_patch() {
  Patch patch;
  for (std::uint32_t j = 0; j <= 4; ++j) {
    for (std::uint32_t i = 0; i <= 4; ++i) {
      const float x = static_cast<float>(i) / 4, y = static_cast<float>(j) / 4;
      patch.positions.insert(patch.positions.end(), {x, y, x * x / 2});
      const glm::vec3 normal = glm::normalize(glm::vec3(-x, 0, 1));
      patch.normals.insert(patch.normals.end(), {normal.x, normal.y, normal.z});
      patch.uvs.insert(patch.uvs.end(), {x, y});
      const std::uint32_t at = j * 5 + i;
      if (i < 4 && j < 4) patch.indices.insert(patch.indices.end(), {at, at + 1, at + 6, at, at + 6, at + 5});
    }
  }
  return patch;
}

TinyGltf plain_patch() {
  const Patch patch = make_patch();
  TinyGltf file = empty_file();
  file.add(patch.positions, kFloat, "VEC3", patch.vertices());
  file.add(patch.indices, kUInt, "SCALAR", patch.indices.size());
  file.primitive()["attributes"]["NORMAL"] = file.add(patch.normals, kFloat, "VEC3", patch.vertices());
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add(patch.uvs, kFloat, "VEC2", patch.vertices());
  return file;
}

TinyGltf draco_patch(bool edgebreaker) {
  const Patch patch = make_patch();
  TinyGltf file = empty_file();
  std::size_t points = 0;
  const int view = file.add_view(draco_bytes(patch, edgebreaker, points));
  file.json["accessors"] = {declared(kFloat, "VEC3", points), declared(kUShort, "SCALAR", patch.indices.size()),
                            declared(kFloat, "VEC3", points), declared(kFloat, "VEC2", points)};
  file.primitive()["attributes"] = {{"POSITION", 0}, {"NORMAL", 2}, {"TEXCOORD_0", 3}};
  file.primitive()["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return file;
}

TinyGltf meshopt_patch() {
  const Patch patch = make_patch();
  TinyGltf file = empty_file();
  std::size_t plain_bytes = 0;
  const auto add = [&](const std::string& encoded, std::size_t count, std::size_t stride, const char* mode,
                       const char* filter) {
    const std::size_t begin = file.binary.size();
    file.binary += encoded + std::string((4 - encoded.size() % 4) % 4, '\0');
    file.json["bufferViews"].push_back({{"buffer", 1},
                                        {"byteOffset", plain_bytes},
                                        {"byteLength", count * stride},
                                        {"extensions",
                                         {{"EXT_meshopt_compression",
                                           {{"buffer", 0},
                                            {"byteOffset", begin},
                                            {"byteLength", encoded.size()},
                                            {"byteStride", stride},
                                            {"count", count},
                                            {"mode", mode},
                                            {"filter", filter}}}}}});
    plain_bytes += count * stride;
  };
  const auto vertices = [&](const void* data, std::size_t stride) {
    std::string out(meshopt_encodeVertexBufferBound(patch.vertices(), stride), '\0');
    out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), data,
                                          patch.vertices(), stride));
    return out;
  };
  std::vector<std::uint32_t> exponential(patch.positions.size());
#if MESHOPTIMIZER_VERSION < 190  // that release has only one mode
  meshopt_encodeFilterExp(exponential.data(), patch.vertices(), 12, 15, patch.positions.data());
#else
  meshopt_encodeFilterExp(exponential.data(), patch.vertices(), 12, 15, patch.positions.data(),
                          meshopt_EncodeExpSharedVector);
#endif
  add(vertices(exponential.data(), 12), patch.vertices(), 12, "ATTRIBUTES", "EXPONENTIAL");
  std::string indices(meshopt_encodeIndexBufferBound(patch.indices.size(), patch.vertices()), '\0');
  indices.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(indices.data()), indices.size(),
                                           patch.indices.data(), patch.indices.size()));
  add(indices, patch.indices.size(), 2, "TRIANGLES", "NONE");
  std::vector<float> four;
  for (std::size_t i = 0; i < patch.vertices(); ++i) {
    four.insert(four.end(), {patch.normals[3 * i], patch.normals[3 * i + 1], patch.normals[3 * i + 2], 0});
  }
  std::vector<std::int8_t> octahedral(patch.vertices() * 4);
  meshopt_encodeFilterOct(octahedral.data(), patch.vertices(), 4, 8, four.data());
  add(vertices(octahedral.data(), 4), patch.vertices(), 4, "ATTRIBUTES", "OCTAHEDRAL");
  file.json["bufferViews"][2]["byteStride"] = 4;
  file.json["buffers"].push_back(
      {{"byteLength", plain_bytes}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  file.json["accessors"] = {declared(kFloat, "VEC3", patch.vertices()),
                            declared(kUShort, "SCALAR", patch.indices.size()),
                            declared(kByte, "VEC3", patch.vertices())};
  for (std::size_t i = 0; i < 3; ++i) file.json["accessors"][i]["bufferView"] = i;
  file.json["accessors"][2]["normalized"] = true;
  file.primitive()["attributes"]["NORMAL"] = 2;
  file.json["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
  return file;
}

std::vector<Seed> seeds() {
  return {{"patch", plain_patch()},           {"edgebreaker", draco_patch(true)},
          {"sequential", draco_patch(false)}, {"meshopt", meshopt_patch()},
          {"sparse strip", sparse_strip()},   {"skin, morph targets, animation", skinned_and_animated()},
          {"textures", textured_seed()},      {"lights, cameras, instancing", lights_and_cameras()}};
}

}  // namespace test
