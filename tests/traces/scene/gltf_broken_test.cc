#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/images.h"

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

// Tests that every file here is refused with one line that names the fault; refusal() checks the form.

TEST(GltfHostile, FilesThatAreNotThereOrNotFiles) {
  const TempFolder folder;
  EXPECT_THROW(traces::load_gltf(folder.path() / "none.glb"), sim::InputError);
  EXPECT_THROW(traces::load_gltf(folder.path()), sim::InputError);
}

TEST(GltfHostile, EmptyAndMeaninglessFiles) {
  EXPECT_SAYS(refusal(""), "empty");
  EXPECT_SAYS(refusal("hello"), "line 1, column 1");
  EXPECT_SAYS(refusal("{\n  \"asset\": oops}"), "line 2, column 12");
  EXPECT_SAYS(refusal("[]"), "must be an object");
  EXPECT_SAYS(refusal("{\"asset\": {\"version\": 1e999}}"), "out of range");
  refusal("{}");
}

TEST(GltfHostile, AnotherVersion) {
  TinyGltf file;
  file.json["asset"]["version"] = "1.0";
  EXPECT_SAYS(refusal(file.text()), "version '1.0'");
}

TEST(GltfHostile, AGlbCutAnywhere) {
  const std::string whole = TinyGltf().glb();
  for (std::size_t size = 4; size < whole.size(); size += 7) EXPECT_SAYS(refusal(whole.substr(0, size)), "bytes");
}

TEST(GltfHostile, AGlbWithWrongChunkSizes) {
  const std::string whole = TinyGltf().glb();
  for (const std::size_t at : {8U, 12U, 16U}) {
    for (const char byte : {'\xff', '\x7f', '\x00'}) {
      std::string file = whole;
      file[at + 2] = byte;
      file[at + 3] = byte;
      if (file != whole) refusal(file);
    }
  }
  std::string bin_too_long = whole;
  const std::size_t bin = whole.size() - TinyGltf().binary.size() - 8;
  bin_too_long[bin] = static_cast<char>(bin_too_long[bin] + 8);
  EXPECT_SAYS(refusal(bin_too_long), "longer than the file");
}

TEST(GltfHostile, JsonTwoHundredThousandDeep) {
  std::string deep = "{\"asset\": {\"version\": \"2.0\"}, \"extras\": ";
  deep += std::string(200'000, '[') + std::string(200'000, ']') + "}";
  EXPECT_SAYS(refusal(deep), "the JSON is nested too deeply; allowed: 128 levels");
  EXPECT_SAYS(refusal(std::string(200'000, '{')), "nested too deeply");
}

TEST(GltfHostile, BracketsInStringsDoNotCountAsDepth) {
  TinyGltf file;
  file.json["nodes"][0]["name"] = "\\\"{" + std::string(500, '[');
  EXPECT_EQ(load(file).instances.size(), 1U);
}

TEST(GltfHostile, ExtensionsThatMustBeUnderstood) {
  for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp", "KHR_materials_sheen", "VENDOR_unheard_of"}) {
    TinyGltf file;
    file.json["extensionsRequired"] = {name};
    EXPECT_SAYS(refusal(file.text()), name);
    file.json.erase("extensionsRequired");
    file.json["extensionsUsed"] = {name};
    const traces::Scene scene = load(file);
    ASSERT_EQ(scene.warnings.size(), 1U);
    EXPECT_SAYS(scene.warnings[0], name);
  }
}

TEST(GltfHostile, LinksThatLeadElsewhere) {
  const TempFolder outside, folder;
  outside.write("secret.bin", TinyGltf().binary);
  TinyGltf file;
  file.json["buffers"][0]["uri"] = "link.bin";
  const auto path = folder.write("a.gltf", file.text());
  const auto said = [&] {
    try {
      traces::load_gltf(path);
    } catch (const sim::InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  std::filesystem::create_symlink(outside.path() / "secret.bin", folder.path() / "link.bin");
  EXPECT_SAYS(said(), "leads out of the file's folder");
  std::filesystem::remove(folder.path() / "link.bin");
  std::filesystem::create_directory_symlink(outside.path(), folder.path() / "in");
  file.json["buffers"][0]["uri"] = "in/secret.bin";
  folder.write("a.gltf", file.text());
  EXPECT_SAYS(said(), "leads out of the file's folder");
  std::filesystem::create_symlink("gone.bin", folder.path() / "dangling.bin");
  file.json["buffers"][0]["uri"] = "dangling.bin";
  folder.write("a.gltf", file.text());
  EXPECT_SAYS(said(), "'dangling.bin' is missing");
  folder.write("real.bin", TinyGltf().binary);
  std::filesystem::create_symlink("real.bin", folder.path() / "near.bin");
  file.json["buffers"][0]["uri"] = "near.bin";
  folder.write("a.gltf", file.text());
  EXPECT_EQ(traces::load_gltf(path).instances.size(), 1U) << "a link within the folder is as good as a file";
}

TEST(GltfHostile, UrisThatLeadElsewhere) {
  for (const char* uri :
       {"../a.bin", "x/../../a.bin", "%2e%2e/a.bin", "..%2fa.bin", "/etc/passwd", "%2Fetc/passwd", "file:///etc/passwd",
        "https://example.org/a.bin", "//example.org/a.bin", "..\\a.bin", "C:/a.bin", "a%00.bin"}) {
    TinyGltf buffer, image;
    buffer.json["buffers"][0]["uri"] = uri;
    EXPECT_SAYS(refusal(buffer.text()), "allowed are data: URIs and files in the same folder or below");
    image.json["images"] = {{{"uri", uri}}};
    EXPECT_SAYS(refusal(image.text()), "allowed are data: URIs and files in the same folder or below");
  }
}

TEST(GltfHostile, FilesThatAreMissing) {
  TinyGltf buffer, image;
  buffer.json["buffers"][0]["uri"] = "gone.bin";
  EXPECT_SAYS(refusal(buffer.text()), "'gone.bin' is missing");
  image.json["images"] = {{{"uri", "gone.png"}}};
  EXPECT_SAYS(refusal(image.text()), "images[0]: the file 'gone.png' is missing");
}

std::string with_image(const std::string& bytes, const traces::SceneLimits& limits = {}) {
  TinyGltf file;
  file.json["images"] = {{{"bufferView", file.add_view(bytes)}, {"mimeType", "image/png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  return refusal(file.text(), limits);
}

TEST(GltfHostile, ImagesThatAreNone) {
  EXPECT_SAYS(with_image("GIF89a, or something like it"), "images[0]: neither PNG nor JPEG");
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 64, 64, std::vector<std::uint8_t>(64 * 64 * 3, 99));
  const std::string png = read_bytes(folder.path() / "a.png");
  EXPECT_SAYS(with_image(png.substr(0, png.size() / 2)), "images[0]");
  EXPECT_SAYS(with_image(png, {.pixels = 1000}), "64 x 64 pixels, allowed are 1000");
}

TEST(GltfHostile, AnImageOutsideItsBuffer) {
  TinyGltf file;
  file.json["images"] = {{{"bufferView", 0}, {"mimeType", "image/png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.json["bufferViews"][0]["byteOffset"] = 1'000'000'000;
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  const std::string said = refusal(file.text());
  EXPECT_TRUE(said.find("leave their buffer") != std::string::npos ||
              said.find("out of bounds of its buffer") != std::string::npos)  // newer tinygltf
      << said;
}

TEST(GltfHostile, MoreThanTheLimits) {
  TinyGltf file;
  for (int i = 1; i < 20; ++i) {
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"].push_back(i);
  }
  EXPECT_SAYS(refusal(file.text(), {.nodes = 10}), "'nodes' has 20 entries, allowed are 10");
  EXPECT_SAYS(refusal(file.text(), {.memory = {100}}), "more than limits.memory, 100 B; allowed: a larger one");
  EXPECT_SAYS(refusal(file.text(), {.memory = {file.text().size() * 18 + 500}}), "more than is left of the limit");
}

TEST(GltfHostile, NamesCannotBreakTheLine) {
  TinyGltf file;
  file.node()["name"] = "two\nlines\x1b[31m";
  file.node()["children"] = {0};
  EXPECT_SAYS(refusal(file.text()), "two?lines?[31m");
}

}  // namespace
}  // namespace test
