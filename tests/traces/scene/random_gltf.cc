#include "tests/traces/scene/random_gltf.h"

#include <algorithm>
#include <initializer_list>

#include "sim/hash.h"
#include "traces/scene/images.h"

namespace test {
namespace {

using nlohmann::json;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  std::size_t below(std::size_t limit) { return sim::hash(seed_, count_++) % limit; }
  bool one_in(std::size_t n) { return below(n) == 0; }
  float between(double least, double most) {
    return static_cast<float>(least + (most - least) * static_cast<double>(below(1 << 20)) / (1 << 20));
  }
  /// Returns 0, 1 or a number in between.
  float share() { return one_in(3) ? static_cast<float>(below(2)) : between(0, 1); }
  json shares(std::size_t count) {
    json list = json::array();
    for (std::size_t i = 0; i < count; ++i) list.push_back(share());
    return list;
  }
  std::vector<float> numbers(std::size_t count, double least, double most) {
    std::vector<float> list;
    for (std::size_t i = 0; i < count; ++i) list.push_back(between(least, most));
    return list;
  }
  const char* one_of(std::initializer_list<const char*> words) { return words.begin()[below(words.size())]; }

 private:
  std::uint64_t seed_, count_ = 0;
};

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : draw_(seed) {}

  TinyGltf make() {
    file_.json["nodes"] = json::array();
    file_.json["meshes"] = json::array();
    file_.json["scenes"][0]["nodes"] = json::array();
    add_textures();
    for (std::size_t i = 0; i < 3; ++i) add_material();
    add_lights_and_cameras();
    const std::size_t nodes = 4 + draw_.below(8);
    for (std::size_t i = 0; i < nodes; ++i) add_node();
    skins_ = 1 + draw_.below(2);
    for (std::size_t i = 0; i < skins_; ++i) add_skin();
    for (std::size_t i = 0; i < 4; ++i) add_mesh();
    for (json& node : file_.json["nodes"]) hang_things_on(node);
    file_.json["nodes"][0]["mesh"] = 0;
    if (draw_.one_in(2)) add_animation();
    return std::move(file_);
  }

 private:
  json& list(const char* name) { return file_.json[name]; }
  std::size_t any(const char* name) { return draw_.below(list(name).size()); }

  void add_textures() {
    const TempFolder folder;
    for (int i = 0; i < 2; ++i) {
      std::vector<std::uint8_t> pixels(12);
      for (std::uint8_t& byte : pixels) byte = static_cast<std::uint8_t>(draw_.below(256));
      traces::write_png(folder.path() / "a.png", 2, 2, pixels);
      json image = {{"bufferView", file_.add_view(read_bytes(folder.path() / "a.png"))}, {"mimeType", "image/png"}};
      list("images").push_back(image);
      list("textures").push_back({{"source", i}});
    }
    list("samplers") = {{{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}}};
    if (draw_.one_in(2)) list("textures")[1]["sampler"] = 0;
  }
  json texture() {
    json use = {{"index", draw_.below(2)}};
    if (draw_.one_in(3)) use["texCoord"] = 1;
    if (draw_.one_in(4)) {
      use["extensions"]["KHR_texture_transform"] = {{"offset", draw_.shares(2)}, {"rotation", draw_.between(-3, 3)}};
    }
    return use;
  }
  void add_material() {
    json m = json::object();
    json& pbr = m["pbrMetallicRoughness"] = json::object();
    if (draw_.one_in(2)) pbr["baseColorFactor"] = draw_.shares(4);
    if (draw_.one_in(2)) pbr["baseColorTexture"] = texture();
    if (draw_.one_in(2)) pbr["metallicFactor"] = draw_.share();
    if (draw_.one_in(2)) pbr["roughnessFactor"] = draw_.share();
    if (draw_.one_in(4)) pbr["metallicRoughnessTexture"] = texture();
    if (draw_.one_in(3)) m["normalTexture"] = texture();
    if (draw_.one_in(3)) m["occlusionTexture"] = texture();
    if (draw_.one_in(3)) m["emissiveTexture"] = texture();
    if (draw_.one_in(3)) m["emissiveFactor"] = draw_.shares(3);
    if (draw_.one_in(3)) m["alphaMode"] = draw_.one_of({"OPAQUE", "MASK", "BLEND"});
    if (draw_.one_in(4)) m["alphaCutoff"] = draw_.between(0, 2);
    if (draw_.one_in(2)) m["doubleSided"] = draw_.one_in(2);
    json& khr = m["extensions"] = json::object();
    if (draw_.one_in(6)) khr["KHR_materials_unlit"] = json::object();
    if (draw_.one_in(3)) khr["KHR_materials_ior"]["ior"] = draw_.one_in(3) ? 0.0F : draw_.between(1, 3);
    if (draw_.one_in(3)) khr["KHR_materials_transmission"]["transmissionFactor"] = draw_.share();
    if (draw_.one_in(3)) {
      khr["KHR_materials_volume"] = {{"thicknessFactor", draw_.share()},
                                     {"attenuationDistance", draw_.between(1e-3, 10)},
                                     {"attenuationColor", draw_.shares(3)}};
    }
    if (draw_.one_in(3)) khr["KHR_materials_clearcoat"] = {{"clearcoatFactor", draw_.share()}};
    if (draw_.one_in(3)) khr["KHR_materials_specular"] = {{"specularFactor", draw_.share()}};
    if (draw_.one_in(4)) khr["KHR_materials_emissive_strength"]["emissiveStrength"] = draw_.between(0, 20);
    list("materials").push_back(m);
  }
  void add_lights_and_cameras() {
    json& lights = file_.json["extensions"]["KHR_lights_punctual"]["lights"];
    for (const char* type : {"point", "directional", "spot"}) {
      json light = {{"type", type}, {"intensity", draw_.between(0, 5)}, {"color", draw_.shares(3)}};
      if (draw_.one_in(2)) light["range"] = draw_.between(0.1, 50);
      if (light["type"] == "spot") {
        light["spot"] = {{"outerConeAngle", draw_.one_in(3) ? 0.0F : draw_.between(0, 2)},
                         {"innerConeAngle", draw_.between(0, 1)}};
      }
      lights.push_back(light);
    }
    list("cameras") = {{{"type", "perspective"}, {"perspective", {{"yfov", draw_.between(0.1, 3)}, {"znear", 0.1}}}}};
  }

  void add_node() {
    json node = json::object();
    const std::size_t index = list("nodes").size();
    switch (draw_.below(4)) {
      case 0:
        break;  // a node without transform
      case 1: {
        std::vector<float> m = draw_.numbers(16, -2, 2);
        m[3] = m[7] = m[11] = 0;
        m[15] = draw_.one_in(4) ? 2.0F : 1.0F;
        const std::size_t column = draw_.below(3);
        if (draw_.one_in(3)) std::fill_n(m.begin() + static_cast<std::ptrdiff_t>(4 * column), 3, 0.0F);
        node["matrix"] = m;
        break;
      }
      default:
        if (draw_.one_in(2)) node["translation"] = draw_.numbers(3, -5, 5);
        if (draw_.one_in(2)) node["rotation"] = draw_.numbers(4, -1, 1);
        if (draw_.one_in(2)) node["scale"] = draw_.numbers(3, -2, 2);
        if (draw_.one_in(3)) node["scale"] = {draw_.below(2), 1, draw_.below(2)};
    }
    if (draw_.one_in(2)) node["name"] = "node " + std::to_string(index);
    list("nodes").push_back(node);
    if (index == 0 || draw_.one_in(3)) {
      file_.json["scenes"][0]["nodes"].push_back(index);
    } else {
      list("nodes")[draw_.below(index)]["children"].push_back(index);
    }
  }
  void add_skin() {
    json skin = {{"joints", json::array()}};
    for (std::size_t i = 0; i < kJoints; ++i) skin["joints"].push_back(any("nodes"));
    if (draw_.one_in(2)) {
      skin["inverseBindMatrices"] = file_.add(draw_.numbers(16 * kJoints, -1, 1), kFloat, "MAT4", kJoints);
    }
    list("skins").push_back(skin);
  }
  void hang_things_on(json& node) {
    if (draw_.one_in(3)) {
      const std::size_t mesh = node["mesh"] = any("meshes");
      if (draw_.one_in(2) && mesh % 2 == 1) node["skin"] = draw_.below(skins_);
      if (draw_.one_in(4)) {
        node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
            file_.add(draw_.numbers(6, -3, 3), kFloat, "VEC3", 2);
      }
    }
    if (draw_.one_in(4)) node["camera"] = 0;
    if (draw_.one_in(3)) node["extensions"]["KHR_lights_punctual"]["light"] = draw_.below(3);
    if (draw_.one_in(6)) node["extras"]["focus"] = true;
  }

  int floats(std::size_t components, double least, double most) {
    static const char* const kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    return file_.add(draw_.numbers(kVertices * components, least, most), kFloat, kTypes[components], kVertices);
  }
  json primitive(std::size_t targets, bool skinned) {
    json attributes = {{"POSITION", floats(3, -2, 2)}};
    const bool normals = draw_.one_in(2);
    if (normals) attributes["NORMAL"] = floats(3, -3, 3);
    if (draw_.one_in(3)) attributes["TANGENT"] = floats(4, -1, 1);
    if (draw_.one_in(2)) attributes["TEXCOORD_0"] = floats(2, -2, 2);
    if (draw_.one_in(2)) attributes["TEXCOORD_1"] = floats(2, 0, 1);
    if (draw_.one_in(3)) attributes["COLOR_0"] = floats(3 + draw_.below(2), -0.5, 1.5);
    if (skinned) {
      std::vector<std::uint8_t> joints;
      for (std::size_t i = 0; i < 4 * kVertices; ++i) joints.push_back(static_cast<std::uint8_t>(draw_.below(kJoints)));
      attributes["JOINTS_0"] = file_.add(joints, kUByte, "VEC4", kVertices);
      attributes["WEIGHTS_0"] = floats(4, -0.5, 1);
    }
    json p = {{"attributes", attributes}, {"mode", 4 + draw_.below(3)}};
    if (draw_.one_in(2)) {
      std::vector<std::uint16_t> indices;
      for (std::size_t i = 0; i < 12; ++i) indices.push_back(static_cast<std::uint16_t>(draw_.below(kVertices)));
      p["indices"] = file_.add(indices, kUShort, "SCALAR", indices.size());
    }
    if (!draw_.one_in(4)) p["material"] = any("materials");
    for (std::size_t i = 0; i < targets; ++i) {
      json target = {{"POSITION", floats(3, -1, 1)}};
      if (draw_.one_in(2)) target["NORMAL"] = floats(3, -1, 1);
      p["targets"].push_back(target);
    }
    return p;
  }
  /// Adds a random mesh; every other mesh has joints.
  void add_mesh() {
    json mesh = {{"primitives", json::array()}};
    const bool skinned = list("meshes").size() % 2 == 1;
    const std::size_t targets = draw_.one_in(3) ? 1 + draw_.below(2) : 0;
    const std::size_t primitives = 1 + draw_.below(2);
    for (std::size_t i = 0; i < primitives; ++i) {
      mesh["primitives"].push_back(primitive(draw_.one_in(8) ? 1 : targets, skinned));
    }
    if (targets > 0 && draw_.one_in(2)) mesh["weights"] = draw_.numbers(targets, 0, 1);
    list("meshes").push_back(mesh);
  }

  void add_animation() {
    json animation = {{"samplers", json::array()}, {"channels", json::array()}};
    const std::size_t channels = 1 + draw_.below(4);
    for (std::size_t i = 0; i < channels; ++i) {
      const std::size_t keys = 1 + draw_.below(4);
      const std::string path = draw_.one_of({"translation", "rotation", "scale"});
      const std::string interpolation = draw_.one_of({"LINEAR", "STEP", "CUBICSPLINE"});
      std::vector<float> times = draw_.numbers(keys, draw_.one_in(4) ? -1 : 0, 3);
      if (draw_.one_in(4)) times.assign(keys, 1);
      std::ranges::sort(times);
      const std::size_t numbers = keys * (path == "rotation" ? 4 : 3) * (interpolation == "CUBICSPLINE" ? 3 : 1);
      const std::size_t values = keys * (interpolation == "CUBICSPLINE" ? 3 : 1);
      const int input = file_.add(times, kFloat, "SCALAR", keys);
      const int output = file_.add(draw_.numbers(numbers, -1, 1), kFloat, path == "rotation" ? "VEC4" : "VEC3", values);
      animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
      animation["channels"].push_back({{"sampler", i}, {"target", {{"node", any("nodes")}, {"path", path}}}});
    }
    list("animations").push_back(animation);
  }

  static constexpr std::size_t kVertices = 6, kJoints = 3;
  Draw draw_;
  TinyGltf file_;
  std::size_t skins_ = 0;
};

}  // namespace

TinyGltf random_gltf(std::uint64_t seed) { return Maker(seed).make(); }

}  // namespace test
