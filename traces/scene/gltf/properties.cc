#include "traces/scene/gltf/properties.h"

#include <algorithm>
#include <array>
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
      if (key == "extras" || key == "extensions") continue;  // anybody's, or read where they are understood
      const std::string here = at.empty() ? sim::printable(key) : fmt::format("{}.{}", at, sim::printable(key));
      if (member.is_structured()) {
        check(member, here, at.empty() ? std::string_view(key) : list);
      } else {
        check_property(key, member, here, list);
      }
    }
  }

 private:
  void check_property(std::string_view key, const Json& value, const std::string& at, std::string_view list) const {
    if (value.is_number() && !value.is_number_unsigned() && std::ranges::find(kIndices, key) != kIndices.end()) {
      refuse(at, value, "0 1 2 ...");
    }
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
