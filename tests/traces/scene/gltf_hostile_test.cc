#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/images.h"

// Tests that every file here is refused with one line that names the fault; refusal() checks the form.

namespace test {
namespace {

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
              said.find("out of bounds of its buffer") != std::string::npos)  // by newer releases of tinygltf
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
