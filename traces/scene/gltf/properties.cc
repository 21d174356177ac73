#include "traces/scene/gltf/properties.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "traces/scene/gltf/schema.h"

namespace traces::gltf {
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
