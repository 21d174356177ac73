#include "traces/scene/gltf/properties.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace traces::gltf {
namespace {

using Json = nlohmann::json;

/// Properties that are indices wherever they stand, and may be left out.
constexpr std::array<std::string_view, 14> kIndices = {
    "scene", "mesh",   "camera",  "skin",       "material", "source", "sampler",
    "index", "buffer", "indices", "bufferView", "skeleton", "node",   "inverseBindMatrices"};

/// A property that has one of a few values, below one of the document's lists.
struct Choice {
  std::string_view list, property;
  std::string_view allowed;  ///< numbers or words with blanks between them
};
constexpr std::array<Choice, 7> kChoices = {{
    {"meshes", "mode", "0 1 2 3 4 5 6"},
    {"samplers", "wrapS", "33071 33648 10497"},
    {"samplers", "wrapT", "33071 33648 10497"},
    {"samplers", "magFilter", "9728 9729"},
    {"samplers", "minFilter", "9728 9729 9984 9985 9986 9987"},
    {"materials", "alphaMode", "OPAQUE MASK BLEND"},
    {"cameras", "type", "perspective orthographic"},
}};

/// A property that is a number, or a list of them, below one of the document's lists. A list of another length is left
/// to the loader, which warns.
struct Quantity {
  std::string_view list, property;
  double least, most;
  std::string_view allowed;
  bool is_list = false;
  bool is_above = false;  ///< `least` itself is not allowed
};
constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr std::array<Quantity, 21> kQuantities = {{
    {"materials", "baseColorFactor", 0, 1, "4 numbers of 0 to 1", true},
    {"materials", "metallicFactor", 0, 1, "0 to 1"},
    {"materials", "roughnessFactor", 0, 1, "0 to 1"},
    {"materials", "emissiveFactor", 0, 1, "3 numbers of 0 to 1", true},
    {"materials", "alphaCutoff", 0, kAny, "0 or more"},
    {"materials", "scale", -kAny, kAny, "a number"},
    {"materials", "strength", 0, 1, "0 to 1"},
    {"materials", "clearcoatFactor", 0, 1, "0 to 1"},
    {"materials", "clearcoatRoughnessFactor", 0, 1, "0 to 1"},
    {"materials", "transmissionFactor", 0, 1, "0 to 1"},
    {"materials", "specularFactor", 0, 1, "0 to 1"},
    {"materials", "specularColorFactor", 0, kAny, "3 numbers of 0 or more", true},
    {"materials", "ior", 0, kAny, "0, or 1 or more"},
    {"materials", "emissiveStrength", 0, kAny, "0 or more"},
    {"materials", "thicknessFactor", 0, kAny, "0 or more"},
    {"materials", "attenuationDistance", 0, kAny, "more than 0", false, true},
    {"materials", "attenuationColor", 0, 1, "3 numbers of 0 to 1", true},
    {"cameras", "aspectRatio", 0, kAny, "more than 0", false, true},
    {"cameras", "yfov", 0, kAny, "more than 0, less than pi", false, true},
    {"cameras", "zfar", 0, kAny, "more than 0", false, true},
    {"cameras", "znear", 0, kAny, "0 or more"},
}};

bool is_within(const Json& value, const Quantity& quantity) {
  if (!value.is_number()) return false;
  const auto number = value.get<double>();
  if (quantity.property == "ior" && number > 0 && number < 1) return false;
  return (quantity.is_above ? number > quantity.least : number >= quantity.least) && number <= quantity.most;
}

bool fits(const Json& value, const Quantity& quantity) {
  const auto is_one = [&](const Json& number) { return is_within(number, quantity); };
  return quantity.is_list ? value.is_array() && std::ranges::all_of(value, is_one) : is_one(value);
}

bool is_among(const std::string& value, std::string_view allowed) {
  return !value.empty() && value.find(' ') == std::string::npos &&
         fmt::format(" {} ", allowed).find(fmt::format(" {} ", value)) != std::string::npos;
}

class Checker {
 public:
  explicit Checker(const std::string& name) : name_(name) {}

  /// `list`: of the document, in which the value stands.
  void check(const Json& value, const std::string& at, std::string_view list) const {
    if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        if (value[i].is_structured()) check(value[i], fmt::format("{}[{}]", at, i), list);
      }
      return;
    }
    for (const auto& [key, member] : value.items()) {
      if (key == "extras") continue;  // anybody's
      const std::string here = at.empty() ? sim::printable(key) : fmt::format("{}.{}", at, sim::printable(key));
      if (key == "extensions") {
        check_extensions(member, here, list);
        continue;
      }
      check_property(key, member, here, list);
      if (member.is_structured()) check(member, here, at.empty() ? std::string_view(key) : list);
    }
  }

 private:
  /// Those of materials; others are anybody's, or read where they are understood.
  void check_extensions(const Json& extensions, const std::string& at, std::string_view list) const {
    if (list != "materials" || !extensions.is_object()) return;
    for (const auto& [name, extension] : extensions.items()) {
      if (!name.starts_with("KHR_materials_") || !extension.is_object()) continue;
      for (const auto& [key, member] : extension.items()) {
        check_quantity(key, member, fmt::format("{}.{}.{}", at, sim::printable(name), sim::printable(key)), list);
      }
    }
  }
  void check_quantity(std::string_view key, const Json& value, const std::string& at, std::string_view list) const {
    for (const Quantity& quantity : kQuantities) {
      if (quantity.list != list || quantity.property != key) continue;
      if (!fits(value, quantity)) refuse(at, value, quantity.allowed);
    }
  }
  void check_property(std::string_view key, const Json& value, const std::string& at, std::string_view list) const {
    if (value.is_number() && !value.is_number_unsigned() && std::ranges::find(kIndices, key) != kIndices.end()) {
      refuse(at, value, "0 1 2 ...");
    }
    if (list == "materials" && key == "doubleSided" && !value.is_boolean()) refuse(at, value, "true false");
    check_quantity(key, value, at, list);
    for (const Choice& choice : kChoices) {
      if (choice.list != list || choice.property != key) continue;
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      const bool are_words = choice.allowed.front() > '9';
      if (are_words != value.is_string() || !is_among(text, choice.allowed)) refuse(at, value, choice.allowed);
    }
  }
  [[noreturn]] void refuse(const std::string& at, const Json& value, std::string_view allowed) const {
    const std::string shown = sim::json_line(value);
    throw sim::InputError(fmt::format("{}: {} is {}; allowed: {}", name_, at, sim::printable(shown, 60), allowed));
  }

  const std::string& name_;
};

}  // namespace

void check_properties(const Json& json, const std::string& name) { Checker(name).check(json, "", ""); }

}  // namespace traces::gltf
