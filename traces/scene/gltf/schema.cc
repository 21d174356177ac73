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

Property object_property(std::string_view name, std::string_view kind) {
  return {.name = name, .type = kObject, .kind = kind};
}
Property object_list(std::string_view name, std::string_view kind) {
  return {.name = name, .type = kObject, .kind = kind, .is_list = true};
}
Property make_required(Property property) {
  property.required = true;
  return property;
}
Property index_property(std::string_view name) { return {.name = name, .type = kIndex}; }
Property index_list(std::string_view name) { return {.name = name, .type = kIndex, .is_list = true}; }
Property count_property(std::string_view name) { return {.name = name, .type = kCount}; }
Property text_property(std::string_view name) { return {.name = name, .type = kText}; }
Property boolean_property(std::string_view name) { return {.name = name, .type = kBoolean}; }
Property number_property(std::string_view name) { return {.name = name, .type = kNumber}; }
Property number_list(std::string_view name, std::size_t size = 0, std::string_view allowed = {}) {
  return {.name = name, .type = kNumber, .is_list = true, .size = size, .allowed = allowed};
}
/// Returns the rule for a property that is a factor of 0 to 1, or a list of such factors.
Property factor_property(std::string_view name) {
  return {.name = name, .type = kNumber, .least = 0, .most = 1, .allowed = "0 to 1"};
}
Property factor_list(std::string_view name, std::size_t size, std::string_view allowed) {
  return {.name = name, .type = kNumber, .is_list = true, .size = size, .least = 0, .most = 1, .allowed = allowed};
}
Property non_negative_property(std::string_view name) {
  return {.name = name, .type = kNumber, .least = 0, .allowed = "0 or more"};
}
Property positive_property(std::string_view name, std::string_view allowed = "more than 0") {
  return {.name = name, .type = kNumber, .least = 0, .is_above = true, .allowed = allowed};
}
Property text_choice(std::string_view name, std::string_view allowed) {
  return {.name = name, .type = kText, .allowed = allowed, .is_choice = true};
}
Property code_choice(std::string_view name, std::string_view allowed) {
  return {.name = name, .type = kCount, .allowed = allowed, .is_choice = true};
}

/// Returns the rules that JSON of buffers, buffer views, accessors and meshes must satisfy.
ObjectKinds geometry_kinds() {
  return {
      {"accessor",
       {index_property("bufferView"), count_property("byteOffset"), make_required(count_property("componentType")),
        make_required(count_property("count")), number_list("max"), number_list("min"), boolean_property("normalized"),
        object_property("sparse", "sparse"), make_required(text_property("type"))}},
      {"sparse",
       {make_required(count_property("count")), make_required(object_property("indices", "sparse indices")),
        make_required(object_property("values", "sparse values"))}},
      {"sparse indices",
       {make_required(index_property("bufferView")), count_property("byteOffset"),
        make_required(count_property("componentType"))}},
      {"sparse values", {make_required(index_property("bufferView")), count_property("byteOffset")}},
      {"buffer", {make_required(count_property("byteLength")), text_property("uri")}},
      {"buffer view",
       {make_required(index_property("buffer")), make_required(count_property("byteLength")),
        count_property("byteOffset"), count_property("byteStride"), count_property("target")}},
      {"mesh", {make_required(object_list("primitives", "primitive")), number_list("weights")}},
      {"primitive",
       {make_required(object_property("attributes", "attributes")), index_property("indices"),
        index_property("material"), code_choice("mode", "0 1 2 3 4 5 6"), object_list("targets", "attributes")}},
      {"attributes", {index_property("*")}},
  };
}

/// Returns the rules that JSON of materials, textures and images must satisfy.
ObjectKinds surface_kinds() {
  return {
      {"image", {index_property("bufferView"), text_property("mimeType"), text_property("uri")}},
      {"material",
       {non_negative_property("alphaCutoff"), text_choice("alphaMode", "OPAQUE MASK BLEND"),
        boolean_property("doubleSided"), factor_list("emissiveFactor", 3, "3 numbers of 0 to 1"),
        object_property("emissiveTexture", "texture use"), object_property("normalTexture", "normal texture"),
        object_property("occlusionTexture", "occlusion texture"),
        object_property("pbrMetallicRoughness", "metallic roughness")}},
      {"metallic roughness",
       {factor_list("baseColorFactor", 4, "4 numbers of 0 to 1"), object_property("baseColorTexture", "texture use"),
        factor_property("metallicFactor"), object_property("metallicRoughnessTexture", "texture use"),
        factor_property("roughnessFactor")}},
      {"texture use", {make_required(index_property("index")), index_property("texCoord")}},
      {"normal texture",
       {make_required(index_property("index")), number_property("scale"), index_property("texCoord")}},
      {"occlusion texture",
       {make_required(index_property("index")), factor_property("strength"), index_property("texCoord")}},
      {"sampler",
       {code_choice("magFilter", "9728 9729"), code_choice("minFilter", "9728 9729 9984 9985 9986 9987"),
        code_choice("wrapS", "33071 33648 10497"), code_choice("wrapT", "33071 33648 10497")}},
      {"texture", {index_property("sampler"), index_property("source")}},
  };
}

/// Returns the rules that JSON of the document, its nodes, cameras, lights and animations must satisfy.
ObjectKinds scene_kinds() {
  return {
      {"glTF",
       {object_list("accessors", "accessor"),
        object_list("animations", "animation"),
        object_property("asset", "asset"),
        object_list("bufferViews", "buffer view"),
        object_list("buffers", "buffer"),
        object_list("cameras", "camera"),
        {.name = "extensionsRequired", .type = kText, .is_list = true},
        {.name = "extensionsUsed", .type = kText, .is_list = true},
        object_list("images", "image"),
        object_list("materials", "material"),
        object_list("meshes", "mesh"),
        object_list("nodes", "node"),
        object_list("samplers", "sampler"),
        index_property("scene"),
        object_list("scenes", "scene"),
        object_list("skins", "skin"),
        object_list("textures", "texture")}},
      {"asset",
       {text_property("copyright"), text_property("generator"), text_property("minVersion"), text_property("version")}},
      {"animation",
       {make_required(object_list("channels", "channel")),
        make_required(object_list("samplers", "animation sampler"))}},
      {"channel", {make_required(index_property("sampler")), make_required(object_property("target", "target"))}},
      {"target", {index_property("node"), make_required(text_property("path"))}},
      {"animation sampler",
       {make_required(index_property("input")), text_property("interpolation"),
        make_required(index_property("output"))}},
      {"camera",
       {object_property("orthographic", "orthographic"), object_property("perspective", "perspective"),
        make_required(text_choice("type", "perspective orthographic"))}},
      {"orthographic",
       {make_required(number_property("xmag")), make_required(number_property("ymag")),
        make_required(number_property("zfar")), make_required(non_negative_property("znear"))}},
      {"perspective",
       {positive_property("aspectRatio"), make_required(positive_property("yfov", "more than 0, less than pi")),
        positive_property("zfar"), make_required(non_negative_property("znear"))}},
      {"node",
       {index_property("camera"), index_list("children"), number_list("matrix", 16, "16 numbers"),
        index_property("mesh"), number_list("rotation", 4, "4 numbers"), number_list("scale", 3, "3 numbers"),
        index_property("skin"), number_list("translation", 3, "3 numbers"), number_list("weights")}},
      {"scene", {index_list("nodes")}},
      {"skin",
       {index_property("inverseBindMatrices"), make_required(index_list("joints")), index_property("skeleton")}},
      {"light",
       {number_list("color", 3, "3 numbers"), number_property("intensity"), number_property("range"),
        object_property("spot", "spot"), make_required(text_property("type"))}},
      {"spot", {number_property("innerConeAngle"), number_property("outerConeAngle")}},
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
  static const std::vector<Property> kMeshopt = {index_property("buffer"),     count_property("byteLength"),
                                                 count_property("byteOffset"), count_property("byteStride"),
                                                 count_property("count"),      text_property("filter"),
                                                 text_property("mode")};
  static const ObjectKinds kKinds = {
      {"EXT_mesh_gpu_instancing", {object_property("attributes", "attributes")}},
      {"EXT_meshopt_compression", kMeshopt},
      {"KHR_meshopt_compression", kMeshopt},
      {"KHR_draco_mesh_compression",
       {object_property("attributes", "attributes"), make_required(index_property("bufferView"))}},
      {"KHR_lights_punctual", {index_property("light"), object_list("lights", "light")}},
      {"KHR_materials_clearcoat",
       {factor_property("clearcoatFactor"), object_property("clearcoatTexture", "texture use"),
        factor_property("clearcoatRoughnessFactor"), object_property("clearcoatRoughnessTexture", "texture use"),
        object_property("clearcoatNormalTexture", "normal texture")}},
      {"KHR_materials_emissive_strength", {non_negative_property("emissiveStrength")}},
      {"KHR_materials_ior", {{.name = "ior", .type = kNumber, .least = 0, .allowed = "0, or 1 or more"}}},
      {"KHR_materials_specular",
       {factor_property("specularFactor"),
        object_property("specularTexture", "texture use"),
        {.name = "specularColorFactor",
         .type = kNumber,
         .is_list = true,
         .size = 3,
         .least = 0,
         .allowed = "3 numbers of 0 or more"},
        object_property("specularColorTexture", "texture use")}},
      {"KHR_materials_transmission",
       {factor_property("transmissionFactor"), object_property("transmissionTexture", "texture use")}},
      {"KHR_materials_volume",
       {factor_list("attenuationColor", 3, "3 numbers of 0 to 1"), positive_property("attenuationDistance"),
        non_negative_property("thicknessFactor"), object_property("thicknessTexture", "texture use")}},
      {"KHR_materials_unlit", {}},
      {"KHR_materials_variants", {}},  // the primitive's own material is shown, which is the default
      {"KHR_mesh_quantization", {}},
      {"KHR_texture_transform",
       {number_list("offset", 2, "2 numbers"), number_property("rotation"), number_list("scale", 2, "2 numbers"),
        index_property("texCoord")}},
  };
  return kKinds;
}

bool is_supported_extension(std::string_view name) { return extension_kinds().contains(name); }

std::string supported_extensions() {
  std::vector<std::string_view> names;
  for (const auto& [name, properties] : extension_kinds()) names.push_back(name);
  return fmt::format("{}", fmt::join(names, ", "));
}

namespace {

using sim::Json;

using enum PropertyType;

bool is_within(double number, const Property& property) {
  constexpr double kRounding = 1e-6;
  if (property.name == "ior" && number > kRounding && number < 1 - kRounding) return false;
  const bool is_enough = property.is_above ? number > property.least : number >= property.least - kRounding;
  return is_enough && number <= property.most + kRounding;
}

bool is_listed(const std::string& value, std::string_view allowed) {
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

/// True if a single value (not a list) has the type, range or enumeration value that the property's rule demands.
bool has_valid_value(const Json& value, const Property& property) {
  if (!has_type(value, property.type)) return false;
  if (property.is_choice) {
    return is_listed(value.is_string() ? value.get<std::string>() : sim::json_line(value), property.allowed);
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

  void check_object(const Json& object, const std::string& at, const std::vector<Property>& properties) const {
    for (const auto& [key, member] : object.items()) {
      if (key == "extras") continue;
      if (key == "extensions") {
        check_extensions(member, join_path(at, key));
        continue;
      }
      if (key == "name") check_value(member, join_path(at, key), {.name = "name", .type = kText});
      for (const Property& property : properties) {
        if (property.name == key || property.name == "*") check_property(member, join_path(at, key), property);
      }
    }
    for (const Property& property : properties) {
      if (property.required && !object.contains(property.name)) {
        throw sim::InputError(fmt::format("{}: {} is missing; allowed: {}", name_, join_path(at, property.name),
                                          allowed_values(property)));
      }
    }
  }

 private:
  static std::string join_path(const std::string& at, std::string_view key) {
    return at.empty() ? sim::printable(key) : fmt::format("{}.{}", at, sim::printable(key));
  }
  static std::string_view allowed_values(const Property& property) {
    if (!property.allowed.empty()) return property.allowed;
    return property.is_list ? name_of_list(property.type) : name_of(property.type);
  }
  void check_extensions(const Json& extensions, const std::string& at) const {
    check_value(extensions, at, {.name = "extensions", .type = kObject});
    for (const auto& [name, extension] : extensions.items()) {
      const auto kind = extension_kinds().find(name);
      if (kind == extension_kinds().end()) continue;
      check_value(extension, join_path(at, name), {.name = name, .type = kObject});
      check_object(extension, join_path(at, name), kind->second);
    }
  }
  void check_property(const Json& value, const std::string& at, const Property& property) const {
    if (!property.is_list) {
      check_value(value, at, property);
      if (!property.kind.empty()) check_object(value, at, object_kinds().at(property.kind));
      return;
    }
    if (!value.is_array() || (property.size != 0 && value.size() != property.size)) refuse(at, value, property);
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (property.type == kNumber) {
        if (!has_valid_value(value[i], property)) refuse(at, value, property);
        continue;
      }
      const std::string here = fmt::format("{}[{}]", at, i);
      Property each = property;
      each.is_list = false;
      check_property(value[i], here, each);
    }
  }
  void check_value(const Json& value, const std::string& at, const Property& property) const {
    if (!has_valid_value(value, property)) refuse(at, value, property);
  }
  [[noreturn]] void refuse(const std::string& at, const Json& value, const Property& property) const {
    const std::string shown = sim::json_line(value);
    throw sim::InputError(
        fmt::format("{}: {} is {}; allowed: {}", name_, at, sim::printable(shown, 60), allowed_values(property)));
  }

  const std::string& name_;
};

}  // namespace

void check_properties(const Json& json, const std::string& name) {
  Checker(name).check_object(json, "", object_kinds().at("glTF"));
}

}  // namespace traces::gltf
