#include <cmath>

#include <fmt/format.h>

#include "sim/config/describe.h"
#include "sim/config/quantity.h"
#include "sim/config/value.h"
#include "sim/io/json.h"

namespace sim {
namespace {

/// Escapes characters that have a meaning in regular expressions.
std::string literal(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (std::string_view("\\^$.|?*+()[]{}/").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

/// Accepts a number, or a text of a number with the field's unit.
Json number_schema(const ConfigNode& field, const char* type) {
  Json number = {{"type", type}};
  if (std::isfinite(field.limits.min)) number["minimum"] = field.limits.min;
  if (std::isfinite(field.limits.max)) number["maximum"] = field.limits.max;
  if (field.unit.empty()) return number;
  return {
      {"anyOf", {number, {{"type", "string"}, {"pattern", fmt::format("^[-+.0-9eE]+ +{}$", literal(field.unit))}}}}};
}

Json quantity_schema(std::span<const Unit> units) {
  return {{"type", "string"}, {"pattern", fmt::format("^[0-9]+(\\.[0-9]+)? *({})$", names_of_units(units, "|"))}};
}

Json spread_schema(const ConfigNode& field) {
  const Json number = number_schema(field, "number");
  const Json band = {{"type", "object"},
                     {"properties", {{"low", number}, {"nominal", number}, {"high", number}}},
                     {"required", {"low", "nominal", "high"}},
                     {"additionalProperties", false}};
  return {{"anyOf", {number, band}}};
}

/// Accepts the names, and the booleans that YAML 1.1 readers make of `off` and `on`.
Json enum_schema(const std::vector<std::string_view>& names) {
  Json choices = names;
  for (const std::string_view name : names) {
    if (const std::optional<bool> boolean = boolean_of_word(name)) choices.push_back(*boolean);
  }
  return {{"enum", choices}};
}

Json type_schema(const ConfigNode& field) {
  switch (field.kind()) {
    case FieldKind::kBool:
      return {{"type", "boolean"}};
    case FieldKind::kUint32:
    case FieldKind::kUint64:
      return number_schema(field, "integer");
    case FieldKind::kDouble:
      return number_schema(field, "number");
    case FieldKind::kString:
      return {{"type", "string"}};
    case FieldKind::kFrequency:
      return quantity_schema(frequency_units());
    case FieldKind::kByteSize:
      return quantity_schema(byte_units());
    case FieldKind::kDuration:
      return quantity_schema(duration_units());
    case FieldKind::kAutoCount:
      return {{"anyOf", {number_schema(field, "integer"), {{"const", "auto"}}}}};
    case FieldKind::kTriple:
      return {{"type", "string"}, {"pattern", "^ *[-+.0-9eE]+ +[-+.0-9eE]+ +[-+.0-9eE]+ *$"}};
    case FieldKind::kSpread:
      return spread_schema(field);
    case FieldKind::kSpreadMap:
      return {{"type", "object"}, {"additionalProperties", spread_schema(field)}};
    case FieldKind::kEnum:
      return enum_schema(std::get<EnumTarget>(*field.target).names);
  }
  return {};
}

Json group_schema(const ConfigNode& group) {
  Json properties = {{"extends", {{"type", "string"}, {"description", "configuration file to start from"}}}};
  for (const ConfigNode& node : group.children) {
    Json schema = node.is_group() ? group_schema(node) : type_schema(node);
    if (!node.is_group()) {
      schema["default"] = json_of(group).at(node.key);
      schema["x-unit"] = node.unit;
      schema["x-range"] = allowed_text(node);
      schema["x-affects"] = names_of(node.affects)[static_cast<std::size_t>(node.affects)];
    }
    schema["description"] = node.meaning;
    properties[node.key] = std::move(schema);
  }
  return {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
}

}  // namespace

Json schema_of(const ConfigNode& root) {
  Json schema = group_schema(root);
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema.sort_keys();
  return schema;
}

}  // namespace sim
