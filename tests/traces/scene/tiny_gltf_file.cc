#include "tests/traces/scene/tiny_gltf_file.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "sim/error.h"

namespace test {
namespace {

std::string base64(const std::string& bytes) {
  static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[(group >> (18 - 6 * k)) & 63U] : '=';
  }
  return out;
}

std::string word(std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  return {reinterpret_cast<const char*>(&word), sizeof word};
}

std::string padded(std::string text, char with) {
  while (text.size() % 4 != 0) text += with;
  return text;
}

/// Returns the first buffer of a file, or null if a test has replaced it.
nlohmann::json* first_buffer(nlohmann::json& file) {
  const auto buffers = file.find("buffers");
  if (buffers == file.end() || !buffers->is_array() || buffers->empty() || !(*buffers)[0].is_object()) return nullptr;
  return &(*buffers)[0];
}

}  // namespace

TinyGltf::TinyGltf() {
  json = nlohmann::json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"name": "part", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{}], "bufferViews": [], "accessors": []})");
  add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, kFloat, "VEC3", 3);
  add<std::uint16_t>({0, 1, 2}, kUShort, "SCALAR", 3);
}

int TinyGltf::add_view(const std::string& bytes) {
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
  binary += padded(bytes, '\0');
  return static_cast<int>(json["bufferViews"].size()) - 1;
}

int TinyGltf::add_bytes(const std::string& bytes, int component_type, const std::string& type, std::size_t count,
                        bool normalized) {
  json["accessors"].push_back({{"bufferView", add_view(bytes)},
                               {"componentType", component_type},
                               {"type", type},
                               {"count", count},
                               {"normalized", normalized}});
  return static_cast<int>(json["accessors"].size()) - 1;
}

nlohmann::json& TinyGltf::material() {
  if (!json.contains("materials")) json["materials"].push_back(nlohmann::json::object());
  primitive()["material"] = 0;
  return json["materials"][0];
}

std::string TinyGltf::text() const {
  nlohmann::json whole = json;
  if (nlohmann::json* buffer = first_buffer(whole)) {
    if (!buffer->contains("byteLength")) (*buffer)["byteLength"] = binary.size();
    if (!buffer->contains("uri")) (*buffer)["uri"] = "data:application/octet-stream;base64," + base64(binary);
  }
  return whole.dump();
}

std::string TinyGltf::glb() const {
  nlohmann::json whole = json;
  if (nlohmann::json* buffer = first_buffer(whole)) (*buffer)["byteLength"] = binary.size();
  const std::string text = padded(whole.dump(), ' ');
  const std::string chunks =
      word(text.size()) + word(0x4e4f534a) + text + word(binary.size()) + word(0x004e4942) + binary;
  return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
}

traces::Scene load(const TinyGltf& file, const traces::SceneLimits& limits) {
  const TempFolder folder;
  return traces::load_gltf(folder.write("tiny.gltf", file.text()), limits);
}

std::string refusal(const std::string& bytes, const traces::SceneLimits& limits) {
  const TempFolder folder;
  const std::filesystem::path path = folder.write("bad.gltf", bytes);
  try {
    traces::load_gltf(path, limits);
  } catch (const sim::InputError& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.starts_with(path.string())) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what.substr(std::min(what.size(), path.string().size()));
  }
  ADD_FAILURE() << "the file was not refused";
  return {};
}

}  // namespace test
