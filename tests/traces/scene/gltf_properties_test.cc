#include <utility>

#include <gtest/gtest.h>

#include "tests/traces/scene/gltf_seeds.h"

// Tests of the JSON types that properties may have, and of optional properties.

namespace test {
namespace {

using nlohmann::json;

std::string refusal_with(const std::string& pointer, const json& value) {
  TinyGltf file;
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  file.material()["alphaMode"] = "MASK";
  file.json[json::json_pointer(pointer)] = value;
  return refusal(file.text());
}

TEST(GltfTypes, TheRefusalNamesThePathAndTheExpectedType) {
  EXPECT_SAYS(refusal_with("/materials/0/pbrMetallicRoughness", json::array()),
              "materials[0].pbrMetallicRoughness is []; allowed: an object");
  EXPECT_SAYS(refusal_with("/materials/0/normalTexture", 1), "materials[0].normalTexture is 1; allowed: an object");
  EXPECT_SAYS(refusal_with("/materials", json::object()), "materials is {}; allowed: a list of objects");
  EXPECT_SAYS(refusal_with("/nodes/1", nullptr), "nodes[1] is null; allowed: an object");
  EXPECT_SAYS(refusal_with("/nodes/0/mesh", "0"), "nodes[0].mesh is \"0\"; allowed: 0 1 2 ...");
  EXPECT_SAYS(refusal_with("/nodes/0/mesh", 1ULL << 32), "nodes[0].mesh is 4294967296; allowed: 0 1 2 ...");
  EXPECT_SAYS(refusal_with("/nodes/0/children", 1), "nodes[0].children is 1; allowed: a list of indices");
  EXPECT_SAYS(refusal_with("/nodes/0/translation", {1, "2", 3}),
              "nodes[0].translation is [1,\"2\",3]; allowed: 3 numbers");
  EXPECT_SAYS(refusal_with("/nodes/0/name", 5), "nodes[0].name is 5; allowed: a string");
  EXPECT_SAYS(refusal_with("/meshes/0/weights", {true}), "meshes[0].weights is [true]; allowed: a list of numbers");
  EXPECT_SAYS(refusal_with("/meshes/0/primitives/0/attributes", json::array()),
              "meshes[0].primitives[0].attributes is []; allowed: an object");
  EXPECT_SAYS(refusal_with("/meshes/0/primitives/0/attributes/POSITION", 0.5),
              "meshes[0].primitives[0].attributes.POSITION is 0.5; allowed: 0 1 2 ...");
  EXPECT_SAYS(refusal_with("/accessors/0/count", 3.0),
              "accessors[0].count is 3.0; allowed: a whole number of 0 or more");
  EXPECT_SAYS(refusal_with("/accessors/0/normalized", 0), "accessors[0].normalized is 0; allowed: true false");
  EXPECT_SAYS(refusal_with("/extensionsUsed", "KHR_materials_unlit"), "allowed: a list of strings");
  EXPECT_SAYS(refusal_with("/materials/0/extensions", json::array()),
              "materials[0].extensions is []; allowed: an object");
  EXPECT_SAYS(refusal_with("/materials/0/extensions/KHR_materials_unlit", true),
              "materials[0].extensions.KHR_materials_unlit is true; allowed: an object");
}

TEST(GltfTypes, RequiredPropertiesMustBeThere) {
  TinyGltf file;
  file.primitive().erase("attributes");
  EXPECT_SAYS(refusal(file.text()), "meshes[0].primitives[0].attributes is missing; allowed: an object");
  EXPECT_SAYS(refusal_with("/materials/0/normalTexture", {{"scale", 1}}),
              "materials[0].normalTexture.index is missing; allowed: 0 1 2 ...");
}

/// Replaces each value of the document, one at a time, by a value of another type. The error message must contain the
/// path of the value; for a number in a list, the path of the list.
void expect_types_checked(TinyGltf& file, json& value, const std::string& path) {
  for (std::size_t i = 0; value.is_array() && i < value.size(); ++i) {
    const bool is_index = path.ends_with("nodes") || path.ends_with("children") || path.ends_with("joints");
    const std::string element = value[i].is_number() && !is_index ? path : path + "[" + std::to_string(i) + "]";
    expect_types_checked(file, value[i], element);
  }
  for (auto member = value.begin(); value.is_object() && member != value.end(); ++member) {
    // Values that are not read, or are checked before types.
    if (member.key() == "fallback" || member.key() == "extensionsRequired") continue;
    expect_types_checked(file, *member, path.empty() ? member.key() : path + "." + member.key());
  }
  if (path.empty()) return;
  const json right = std::exchange(value, value.is_boolean() ? json(7) : json(true));
  const std::string said = refusal(file.text());
  value = right;
  EXPECT_EQ(said.substr(0, said.find(" is ")), ": " + path);
  EXPECT_SAYS(said, "; allowed: ");
}

TEST(GltfTypes, AreCheckedOfEveryPropertyThatIsRead) {
  for (Seed& seed : seeds()) {
    SCOPED_TRACE(seed.name);
    expect_types_checked(seed.file, seed.file.json, "");
  }
}

TEST(GltfFactors, AreClampedWithinRoundingAndRefusedBeyond) {
  TinyGltf file;
  file.material()["pbrMetallicRoughness"] = {{"baseColorFactor", {1.000001, -0.000001, 0.5, 1.0000001}},
                                             {"metallicFactor", 1.000001},
                                             {"roughnessFactor", -1e-9}};
  file.material()["emissiveFactor"] = {1.000001, 0, 0};
  const traces::Material m = load(file).materials.at(0);
  EXPECT_EQ(m.base_colour, glm::vec3(1, 0, 0.5F));
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.roughness, 0);
  EXPECT_EQ(m.emission, glm::vec3(1, 0, 0));
  EXPECT_SAYS(refusal_with("/materials/0/pbrMetallicRoughness/metallicFactor", 1.00001),
              "metallicFactor is 1.00001; allowed: 0 to 1");
  EXPECT_SAYS(refusal_with("/materials/0/pbrMetallicRoughness/baseColorFactor", {1, 1, 1}),
              "allowed: 4 numbers of 0 to 1");
}

TEST(GltfOptional, PropertiesMayBeLeftOutWithoutAWarning) {
  TinyGltf file;
  json& attributes = file.primitive()["attributes"];
  attributes["JOINTS_0"] = file.add<std::uint8_t>(std::vector<std::uint8_t>(12, 0), kUByte, "VEC4", 3);
  attributes["WEIGHTS_0"] = file.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4", 3);
  file.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"name", "bone"}}};
  file.json["scenes"][0]["nodes"] = {0, 1};
  file.json["skins"] = {{{"joints", {1}}}};  // without inverseBindMatrices
  const int times = file.add<float>({0, 1}, kFloat, "SCALAR", 2);
  const int moves = file.add<float>({0, 0, 0, 1, 0, 0}, kFloat, "VEC3", 2);
  file.json["animations"] = {{{"samplers", {{{"input", times}, {"output", moves}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"path", "translation"}}}}}}}};  // no node
  EXPECT_EQ(load(file).warnings, std::vector<std::string>{});
}

}  // namespace
}  // namespace test
