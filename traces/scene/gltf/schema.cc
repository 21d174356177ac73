#include "traces/scene/gltf/schema.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <ranges>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace traces::gltf {
namespace {

using enum PropertyType;

Property object(std::string_view name, std::string_view kind) { return {.name = name, .type = kObject, .kind = kind}; }
Property objects(std::string_view name, std::string_view kind) {
  return {.name = name, .type = kObject, .kind = kind, .is_list = true};
}
Property needed(Property property) {
  property.required = true;
  return property;
}
Property index(std::string_view name) { return {.name = name, .type = kIndex}; }
Property indices(std::string_view name) { return {.name = name, .type = kIndex, .is_list = true}; }
Property count(std::string_view name) { return {.name = name, .type = kCount}; }
Property text(std::string_view name) { return {.name = name, .type = kText}; }
Property boolean(std::string_view name) { return {.name = name, .type = kBoolean}; }
Property number(std::string_view name) { return {.name = name, .type = kNumber}; }
Property numbers(std::string_view name, std::size_t size = 0, std::string_view allowed = {}) {
  return {.name = name, .type = kNumber, .is_list = true, .size = size, .allowed = allowed};
}
/// A factor, or a list of factors, of 0 to 1.
Property share(std::string_view name) {
  return {.name = name, .type = kNumber, .least = 0, .most = 1, .allowed = "0 to 1"};
}
Property shares(std::string_view name, std::size_t size, std::string_view allowed) {
  return {.name = name, .type = kNumber, .is_list = true, .size = size, .least = 0, .most = 1, .allowed = allowed};
}
Property from_zero(std::string_view name) {
  return {.name = name, .type = kNumber, .least = 0, .allowed = "0 or more"};
}
Property above_zero(std::string_view name, std::string_view allowed = "more than 0") {
  return {.name = name, .type = kNumber, .least = 0, .is_above = true, .allowed = allowed};
}
Property words(std::string_view name, std::string_view allowed) {
  return {.name = name, .type = kText, .allowed = allowed, .is_choice = true};
}
Property codes(std::string_view name, std::string_view allowed) {
  return {.name = name, .type = kCount, .allowed = allowed, .is_choice = true};
}

/// Buffers, buffer views, accessors, meshes.
ObjectKinds geometry_kinds() {
  return {
      {"accessor",
       {index("bufferView"), count("byteOffset"), needed(count("componentType")), needed(count("count")),
        numbers("max"), numbers("min"), boolean("normalized"), object("sparse", "sparse"), needed(text("type"))}},
      {"sparse",
       {needed(count("count")), needed(object("indices", "sparse indices")),
        needed(object("values", "sparse values"))}},
      {"sparse indices", {needed(index("bufferView")), count("byteOffset"), needed(count("componentType"))}},
      {"sparse values", {needed(index("bufferView")), count("byteOffset")}},
      {"buffer", {needed(count("byteLength")), text("uri")}},
      {"buffer view",
       {needed(index("buffer")), needed(count("byteLength")), count("byteOffset"), count("byteStride"),
        count("target")}},
      {"mesh", {needed(objects("primitives", "primitive")), numbers("weights")}},
      {"primitive",
       {needed(object("attributes", "attributes")), index("indices"), index("material"), codes("mode", "0 1 2 3 4 5 6"),
        objects("targets", "attributes")}},
      {"attributes", {index("*")}},
  };
}

/// Materials, textures and images.
ObjectKinds surface_kinds() {
  return {
      {"image", {index("bufferView"), text("mimeType"), text("uri")}},
      {"material",
       {from_zero("alphaCutoff"), words("alphaMode", "OPAQUE MASK BLEND"), boolean("doubleSided"),
        shares("emissiveFactor", 3, "3 numbers of 0 to 1"), object("emissiveTexture", "texture use"),
        object("normalTexture", "normal texture"), object("occlusionTexture", "occlusion texture"),
        object("pbrMetallicRoughness", "metallic roughness")}},
      {"metallic roughness",
       {shares("baseColorFactor", 4, "4 numbers of 0 to 1"), object("baseColorTexture", "texture use"),
        share("metallicFactor"), object("metallicRoughnessTexture", "texture use"), share("roughnessFactor")}},
      {"texture use", {needed(index("index")), index("texCoord")}},
      {"normal texture", {needed(index("index")), number("scale"), index("texCoord")}},
      {"occlusion texture", {needed(index("index")), share("strength"), index("texCoord")}},
      {"sampler",
       {codes("magFilter", "9728 9729"), codes("minFilter", "9728 9729 9984 9985 9986 9987"),
        codes("wrapS", "33071 33648 10497"), codes("wrapT", "33071 33648 10497")}},
      {"texture", {index("sampler"), index("source")}},
  };
}

/// The document, its nodes, cameras, lights and animations.
ObjectKinds scene_kinds() {
  return {
      {"glTF",
       {objects("accessors", "accessor"),
        objects("animations", "animation"),
        object("asset", "asset"),
        objects("bufferViews", "buffer view"),
        objects("buffers", "buffer"),
        objects("cameras", "camera"),
        {.name = "extensionsRequired", .type = kText, .is_list = true},
        {.name = "extensionsUsed", .type = kText, .is_list = true},
        objects("images", "image"),
        objects("materials", "material"),
        objects("meshes", "mesh"),
        objects("nodes", "node"),
        objects("samplers", "sampler"),
        index("scene"),
        objects("scenes", "scene"),
        objects("skins", "skin"),
        objects("textures", "texture")}},
      {"asset", {text("copyright"), text("generator"), text("minVersion"), text("version")}},
      {"animation", {needed(objects("channels", "channel")), needed(objects("samplers", "animation sampler"))}},
      {"channel", {needed(index("sampler")), needed(object("target", "target"))}},
      {"target", {index("node"), needed(text("path"))}},
      {"animation sampler", {needed(index("input")), text("interpolation"), needed(index("output"))}},
      {"camera",
       {object("orthographic", "orthographic"), object("perspective", "perspective"),
        needed(words("type", "perspective orthographic"))}},
      {"orthographic",
       {needed(number("xmag")), needed(number("ymag")), needed(number("zfar")), needed(from_zero("znear"))}},
      {"perspective",
       {above_zero("aspectRatio"), needed(above_zero("yfov", "more than 0, less than pi")), above_zero("zfar"),
        needed(from_zero("znear"))}},
      {"node",
       {index("camera"), indices("children"), numbers("matrix", 16, "16 numbers"), index("mesh"),
        numbers("rotation", 4, "4 numbers"), numbers("scale", 3, "3 numbers"), index("skin"),
        numbers("translation", 3, "3 numbers"), numbers("weights")}},
      {"scene", {indices("nodes")}},
      {"skin", {index("inverseBindMatrices"), needed(indices("joints")), index("skeleton")}},
      {"light",
       {numbers("color", 3, "3 numbers"), number("intensity"), number("range"), object("spot", "spot"),
        needed(text("type"))}},
      {"spot", {number("innerConeAngle"), number("outerConeAngle")}},
  };
}

}  // namespace

const ObjectKinds& object_kinds() {
  static const ObjectKinds kKinds = [] {
    ObjectKinds kinds = scene_kinds();
    kinds.merge(geometry_kinds());
    kinds.merge(surface_kinds());
    return kinds;
  }();
  return kKinds;
}

const ObjectKinds& extension_kinds() {
  static const std::vector<Property> kMeshopt = {index("buffer"),     count("byteLength"), count("byteOffset"),
                                                 count("byteStride"), count("count"),      text("filter"),
                                                 text("mode")};
  static const ObjectKinds kKinds = {
      {"EXT_mesh_gpu_instancing", {object("attributes", "attributes")}},
      {"EXT_meshopt_compression", kMeshopt},
      {"KHR_meshopt_compression", kMeshopt},
      {"KHR_draco_mesh_compression", {object("attributes", "attributes"), needed(index("bufferView"))}},
      {"KHR_lights_punctual", {index("light"), objects("lights", "light")}},
      {"KHR_materials_clearcoat",
       {share("clearcoatFactor"), object("clearcoatTexture", "texture use"), share("clearcoatRoughnessFactor"),
        object("clearcoatRoughnessTexture", "texture use"), object("clearcoatNormalTexture", "normal texture")}},
      {"KHR_materials_emissive_strength", {from_zero("emissiveStrength")}},
      {"KHR_materials_ior", {{.name = "ior", .type = kNumber, .least = 0, .allowed = "0, or 1 or more"}}},
      {"KHR_materials_specular",
       {share("specularFactor"),
        object("specularTexture", "texture use"),
        {.name = "specularColorFactor",
         .type = kNumber,
         .is_list = true,
         .size = 3,
         .least = 0,
         .allowed = "3 numbers of 0 or more"},
        object("specularColorTexture", "texture use")}},
      {"KHR_materials_transmission", {share("transmissionFactor"), object("transmissionTexture", "texture use")}},
      {"KHR_materials_volume",
       {shares("attenuationColor", 3, "3 numbers of 0 to 1"), above_zero("attenuationDistance"),
        from_zero("thicknessFactor"), object("thicknessTexture", "texture use")}},
      {"KHR_materials_unlit", {}},
      {"KHR_materials_variants", {}},  // the primitive's own material, which is the default, is shown
      {"KHR_mesh_quantization", {}},
      {"KHR_texture_transform",
       {numbers("offset", 2, "2 numbers"), number("rotation"), numbers("scale", 2, "2 numbers"), index("texCoord")}},
  };
  return kKinds;
}

bool is_supported_extension(std::string_view name) { return extension_kinds().contains(name); }

std::string supported_extensions() { return fmt::format("{}", fmt::join(extension_kinds() | std::views::keys, ", ")); }

namespace {

using sim::Json;

using enum PropertyType;

bool is_within(double number, const Property& property) {
  constexpr double kRounding = 1e-6;
  if (property.name == "ior" && number > kRounding && number < 1 - kRounding) return false;
  const bool is_enough = property.is_above ? number > property.least : number >= property.least - kRounding;
  return is_enough && number <= property.most + kRounding;
}

bool is_among(const std::string& value, std::string_view allowed) {
  return !value.empty() && value.find(' ') == std::string::npos &&
         fmt::format(" {} ", allowed).find(fmt::format(" {} ", value)) != std::string::npos;
}

bool has_type(const Json& value, PropertyType type) {
  switch (type) {
    case kObject:
      return value.is_object();
    case kIndex:
      return value.is_number_unsigned() && value.get<std::uint64_t>() <= std::numeric_limits<int>::max();
    case kCount:
      return value.is_number_unsigned();
    case kNumber:
      return value.is_number();
    case kText:
      return value.is_string();
    case kBoolean:
      break;
  }
  return value.is_boolean();
}

/// True if a value that is not a list has the property's type, range and choice.
bool fits(const Json& value, const Property& property) {
  if (!has_type(value, property.type)) return false;
  if (property.is_choice) {
    return is_among(value.is_string() ? value.get<std::string>() : sim::json_line(value), property.allowed);
  }
  return property.type != kNumber || is_within(value.get<double>(), property);
}

std::string_view name_of(PropertyType type) {
  switch (type) {
    case kObject:
      return "an object";
    case kIndex:
      return "0 1 2 ...";
    case kCount:
      return "a whole number of 0 or more";
    case kNumber:
      return "a number";
    case kText:
      return "a string";
    case kBoolean:
      break;
  }
  return "true false";
}

std::string_view name_of_list(PropertyType type) {
  switch (type) {
    case kObject:
      return "a list of objects";
    case kIndex:
      return "a list of indices";
    case kText:
      return "a list of strings";
    default:
      return "a list of numbers";
  }
}

class Checker {
 public:
  explicit Checker(const std::string& name) : name_(name) {}

  void check(const Json& object, const std::string& at, const std::vector<Property>& properties) const {
    for (const auto& [key, member] : object.items()) {
      if (key == "extras") continue;
      if (key == "extensions") {
        check_extensions(member, joined(at, key));
        continue;
      }
      if (key == "name") check_value(member, joined(at, key), {.name = "name", .type = kText});
      for (const Property& property : properties) {
        if (property.name == key || property.name == "*") check_property(member, joined(at, key), property);
      }
    }
    for (const Property& property : properties) {
      if (property.required && !object.contains(property.name)) {
        throw sim::InputError(
            fmt::format("{}: {} is missing; allowed: {}", name_, joined(at, property.name), allowed_by(property)));
      }
    }
  }

 private:
  static std::string joined(const std::string& at, std::string_view key) {
    return at.empty() ? sim::printable(key) : fmt::format("{}.{}", at, sim::printable(key));
  }
  static std::string_view allowed_by(const Property& property) {
    if (!property.allowed.empty()) return property.allowed;
    return property.is_list ? name_of_list(property.type) : name_of(property.type);
  }
  void check_extensions(const Json& extensions, const std::string& at) const {
    check_value(extensions, at, {.name = "extensions", .type = kObject});
    for (const auto& [name, extension] : extensions.items()) {
      const auto kind = extension_kinds().find(name);
      if (kind == extension_kinds().end()) continue;
      check_value(extension, joined(at, name), {.name = name, .type = kObject});
      check(extension, joined(at, name), kind->second);
    }
  }
  void check_property(const Json& value, const std::string& at, const Property& property) const {
    if (!property.is_list) {
      check_value(value, at, property);
      if (!property.kind.empty()) check(value, at, object_kinds().at(property.kind));
      return;
    }
    if (!value.is_array() || (property.size != 0 && value.size() != property.size)) refuse(at, value, property);
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (property.type == kNumber) {
        if (!fits(value[i], property)) refuse(at, value, property);
        continue;
      }
      const std::string here = fmt::format("{}[{}]", at, i);
      Property each = property;
      each.is_list = false;
      check_property(value[i], here, each);
    }
  }
  void check_value(const Json& value, const std::string& at, const Property& property) const {
    if (!fits(value, property)) refuse(at, value, property);
  }
  [[noreturn]] void refuse(const std::string& at, const Json& value, const Property& property) const {
    const std::string shown = sim::json_line(value);
    throw sim::InputError(
        fmt::format("{}: {} is {}; allowed: {}", name_, at, sim::printable(shown, 60), allowed_by(property)));
  }

  const std::string& name_;
};

}  // namespace

void check_properties(const Json& json, const std::string& name) {
  Checker(name).check(json, "", object_kinds().at("glTF"));
}

}  // namespace traces::gltf
