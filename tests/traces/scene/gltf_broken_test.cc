#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/traces/scene/tiny_gltf_file.h"

// Tests that well-formed JSON with invalid content is refused with one line that names the fault.

namespace test {
namespace {

TEST(GltfBroken, NoTriangles) {
  TinyGltf none;
  none.json["nodes"][0].erase("mesh");
  EXPECT_SAYS(refusal(none.text()), "no triangles");
  TinyGltf lines;
  lines.primitive()["mode"] = 1;
  EXPECT_SAYS(refusal(lines.text()), "no triangles");
}

TEST(GltfBroken, ContentOfExtrasIsNotChecked) {
  TinyGltf file;
  file.json["nodes"][0]["extras"] = {{"mesh", -3}};
  EXPECT_NO_THROW(load(file));
}

TEST(GltfBroken, IndicesThatAreNone) {
  const auto with = [](const char* pointer, const nlohmann::json& value) {
    TinyGltf file;
    file.json[nlohmann::json::json_pointer(pointer)] = value;
    return refusal(file.text());
  };
  EXPECT_SAYS(with("/nodes/0/mesh", -3), "nodes[0].mesh is -3; allowed: 0 1 2");
  EXPECT_SAYS(with("/nodes/0/camera", 0.5), "nodes[0].camera is 0.5; allowed: 0 1 2");
  EXPECT_SAYS(with("/meshes/0/primitives/0/material", -1), "meshes[0].primitives[0].material is -1");
  EXPECT_SAYS(with("/scene", -2), "scene is -2");
}

TEST(GltfBroken, ValuesThatStandForNothing) {
  const auto with = [](const char* pointer, const nlohmann::json& value) {
    TinyGltf file;
    file.json[nlohmann::json::json_pointer(pointer)] = value;
    return refusal(file.text());
  };
  EXPECT_SAYS(with("/meshes/0/primitives/0/mode", 9), "meshes[0].primitives[0].mode is 9; allowed: 0 1 2 3 4 5 6");
  EXPECT_SAYS(with("/materials/0/alphaMode", "WEIRD"),
              "materials[0].alphaMode is \"WEIRD\"; allowed: OPAQUE MASK BLEND");
  EXPECT_SAYS(with("/materials/0/alphaMode", "OPAQUE MASK"), "allowed: OPAQUE MASK BLEND");
  EXPECT_SAYS(with("/samplers/0/wrapS", "33071"), "samplers[0].wrapS is \"33071\"; allowed: 33071 33648 10497");
  EXPECT_SAYS(with("/cameras/0/type", "fisheye"), "cameras[0].type is \"fisheye\"");
}

TEST(GltfBroken, QuantitiesOutOfTheirRange) {
  const auto with = [](const std::string& pointer, const nlohmann::json& value) {
    TinyGltf file;
    file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
    file.material()["alphaMode"] = "MASK";
    file.json[nlohmann::json::json_pointer(pointer)] = value;
    return refusal(file.text());
  };
  const std::string m = "/materials/0/", pbr = m + "pbrMetallicRoughness/", khr = m + "extensions/KHR_materials_";
  EXPECT_SAYS(with(m + "alphaCutoff", -3), "materials[0].alphaCutoff is -3; allowed: 0 or more");
  EXPECT_SAYS(with(m + "doubleSided", "yes"), "materials[0].doubleSided is \"yes\"; allowed: true false");
  EXPECT_SAYS(with(m + "emissiveFactor", {0, -1, 0}), "emissiveFactor is [0,-1,0]; allowed: 3 numbers of 0 to 1");
  EXPECT_SAYS(with(m + "normalTexture/scale", "2"), "normalTexture.scale is \"2\"; allowed: a number");
  EXPECT_SAYS(with(m + "occlusionTexture/strength", {1}), "occlusionTexture.strength is [1]; allowed: 0 to 1");
  EXPECT_SAYS(with(pbr + "roughnessFactor", 9), "pbrMetallicRoughness.roughnessFactor is 9; allowed: 0 to 1");
  EXPECT_SAYS(with(pbr + "metallicFactor", -1), "pbrMetallicRoughness.metallicFactor is -1; allowed: 0 to 1");
  EXPECT_SAYS(with(pbr + "baseColorFactor", {1, 1, 1.5, 1}), "allowed: 4 numbers of 0 to 1");
  EXPECT_SAYS(with(khr + "ior/ior", 0.5), "KHR_materials_ior.ior is 0.5; allowed: 0, or 1 or more");
  EXPECT_SAYS(with(khr + "volume/attenuationDistance", 0), "attenuationDistance is 0; allowed: more than 0");
  EXPECT_SAYS(with("/cameras/0/perspective/aspectRatio", 0), "cameras[0].perspective.aspectRatio is 0");
  EXPECT_SAYS(with("/cameras/0/perspective/znear", "near"), "znear is \"near\"; allowed: 0 or more");
}

TEST(GltfBroken, VerticesThatAreNoNumbersOrTooFar) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    TinyGltf file;
    std::memcpy(file.binary.data() + 4, &bad, sizeof bad);
    EXPECT_SAYS(refusal(file.text()), "not a finite number");
  }
  TinyGltf far;
  const float distance = 1e30F;
  std::memcpy(far.binary.data() + 4, &distance, sizeof distance);
  EXPECT_SAYS(refusal(far.text()), "reaches further than");
}

TEST(GltfBroken, IndicesOutOfRange) {
  TinyGltf file;
  file.primitive()["indices"] = file.add<std::uint32_t>({0, 1, 3}, kUInt, "SCALAR", 3);
  EXPECT_SAYS(refusal(file.text()), "index 3 of 3 vertices");
}

TEST(GltfBroken, AccessorsOutsideTheirViewAndViewsOutsideTheirBuffer) {
  for (const auto& count : {nlohmann::json(4), nlohmann::json(1'000'000'000), nlohmann::json(1ULL << 62)}) {
    TinyGltf file;
    file.json["accessors"][0]["count"] = count;
    EXPECT_SAYS(refusal(file.text()), "leave buffer view");
  }
  for (const char* key : {"byteOffset", "byteLength"}) {
    TinyGltf file;
    file.json["bufferViews"][0][key] = std::numeric_limits<std::int64_t>::max();
    EXPECT_SAYS(refusal(file.text()), "leave their buffer");
  }
  TinyGltf offset;
  offset.json["accessors"][0]["byteOffset"] = 8;
  EXPECT_SAYS(refusal(offset.text()), "leave buffer view");
  TinyGltf stride;
  stride.json["bufferViews"][0]["byteStride"] = 4;
  EXPECT_SAYS(refusal(stride.text()), "stride 4");
}

TEST(GltfBroken, AccessorsOfTheWrongKind) {
  TinyGltf type, component, empty;
  type.json["accessors"][0]["type"] = "VEC2";
  EXPECT_SAYS(refusal(type.text()), "wrong type");
  component.json["accessors"][0]["componentType"] = 5130;
  EXPECT_SAYS(refusal(component.text()), "component type 5130");
  empty.json["accessors"][0]["count"] = 0;
  EXPECT_SAYS(refusal(empty.text()), "empty");
  TinyGltf index;
  index.json["accessors"][1]["componentType"] = kShort;
  EXPECT_SAYS(refusal(index.text()), "component type 5122");
}

TEST(GltfBroken, ReferencesToWhatIsNotThere) {
  const auto patched = [](const char* pointer, const nlohmann::json& value) {
    TinyGltf file;
    file.json[nlohmann::json::json_pointer(pointer)] = value;
    return refusal(file.text());
  };
  EXPECT_SAYS(patched("/nodes/0/mesh", 7), "meshes[7]");
  EXPECT_SAYS(patched("/nodes/0/camera", 0), "the file has none");
  EXPECT_SAYS(patched("/nodes/0/children", {9}), "nodes[9]");
  EXPECT_SAYS(patched("/nodes/0/children", {-1}), "nodes[0].children[0] is -1; allowed: 0 1 2");
  EXPECT_SAYS(patched("/scenes/0/nodes", {3}), "nodes[3]");
  EXPECT_SAYS(patched("/scene", 2), "scenes[2]");
  EXPECT_SAYS(patched("/meshes/0/primitives/0/material", 1), "materials[1]");
  EXPECT_SAYS(patched("/meshes/0/primitives/0/attributes/POSITION", 5), "accessors[5]");
  EXPECT_SAYS(patched("/meshes/0/primitives/0/attributes/NORMAL", 5), "accessors[5]");
  patched("/meshes/0/primitives/0/indices", 5);
  EXPECT_SAYS(patched("/accessors/0/bufferView", 5), "bufferViews[5]");
  EXPECT_SAYS(patched("/bufferViews/0/buffer", 5), "buffers[5]");
}

TEST(GltfBroken, CyclesAndNodesWithTwoParents) {
  TinyGltf own_child, cycle, shared;
  own_child.node()["children"] = {0};
  EXPECT_SAYS(refusal(own_child.text()), "must be a tree");
  cycle.json["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}};
  EXPECT_SAYS(refusal(cycle.text()), "must be a tree");
  shared.json["nodes"] = {{{"children", {1, 2}}}, {{"children", {3}}}, {{"children", {3}}}, {{"mesh", 0}}};
  EXPECT_SAYS(refusal(shared.text()), "must be a tree");
}

TEST(GltfBroken, TransformsThatAreNone) {
  TinyGltf matrix, rotation, scale, huge;
  matrix.node()["matrix"] = {1, 2, 3};
  EXPECT_SAYS(refusal(matrix.text()), "16 numbers");
  rotation.node()["rotation"] = {0, 0, 0, 0};
  EXPECT_SAYS(refusal(rotation.text()), "rotation is null");
  scale.node()["scale"] = {1, 1};
  EXPECT_SAYS(refusal(scale.text()), "nodes[0].scale is [1,1]; allowed: 3 numbers");
  huge.node()["scale"] = {1e30, 1, 1};
  EXPECT_SAYS(refusal(huge.text()), "not finite or too large");
}

TEST(GltfBroken, AZeroFilledAccessorOfManyElements) {
  TinyGltf file;
  file.json["accessors"][0].erase("bufferView");
  file.json["accessors"][0]["count"] = 1ULL << 40;
  EXPECT_SAYS(refusal(file.text()), "elements without a buffer view; allowed: 1048576");
}

TEST(GltfBroken, NumbersWhereTheyMakeNoSense) {
  TinyGltf emission, fov;
  emission.material()["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 1e300;
  EXPECT_SAYS(refusal(emission.text()), "emissiveStrength");
  fov.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 0.1}}}}};
  fov.node()["camera"] = 0;
  EXPECT_SAYS(refusal(fov.text()), "yfov is 0");
}

}  // namespace
}  // namespace test
