#include "sim/config/describe.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/config/value.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"

namespace sim {
namespace {

void collect_fields(const ConfigNode& group, std::vector<FieldInfo>& fields) {
  for (const ConfigNode& node : group.children) {
    if (node.is_group()) {
      collect_fields(node, fields);
      continue;
    }
    FieldInfo info{node.path, node.kind(), node.unit, node.meaning, node.limits, node.affects, value_text(node), {}};
    if (const auto* choice = std::get_if<EnumTarget>(&*node.target)) {
      info.choices.assign(choice->names.begin(), choice->names.end());
    }
    fields.push_back(std::move(info));
  }
}

Json band_json(const Band& band) { return {{"low", band.low}, {"nominal", band.nominal}, {"high", band.high}}; }

Json value_json(const ConfigNode& field) {
  switch (field.kind()) {
    case FieldKind::kBool:
      return *std::get<bool*>(*field.target);
    case FieldKind::kUint32:
      return *std::get<std::uint32_t*>(*field.target);
    case FieldKind::kAutoCount: {
      const AutoCount& count = *std::get<AutoCount*>(*field.target);
      if (!count.is_auto) return count.value;
      break;
    }
    case FieldKind::kUint64:
      return *std::get<std::uint64_t*>(*field.target);
    case FieldKind::kDouble:
      return *std::get<double*>(*field.target);
    case FieldKind::kString:
      return with_escaped_bytes(*std::get<std::string*>(*field.target));
    case FieldKind::kBand:
      return band_json(*std::get<Band*>(*field.target));
    case FieldKind::kBandMap: {
      Json map = Json::object();
      for (const auto& [name, band] : *std::get<std::map<std::string, Band>*>(*field.target)) {
        map[name] = band_json(band);
      }
      return map;
    }
    case FieldKind::kFrequency:
    case FieldKind::kByteSize:
    case FieldKind::kDuration:
    case FieldKind::kTriple:
    case FieldKind::kEnum:
      break;
  }
  return value_text(field);
}

/// Escapes '|', which would end a cell of a Markdown table.
std::string escape_cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

constexpr std::size_t kWidestCell = 100;  // longer values, such as large maps, are shown only by `config show`

/// Returns the allowed values of a field, without the unit at the end, which has a separate column.
std::string range_text(const ConfigNode& field) {
  std::string range = allowed_text(field);
  const std::string unit = " " + field.unit;
  if (!field.unit.empty() && range.ends_with(unit)) range.resize(range.size() - unit.size());
  return range;
}

void append_manual_of_group(const ConfigNode& group, std::string& text) {
  std::string rows;
  for (const ConfigNode& node : group.children) {
    if (node.is_group()) continue;
    const std::string value = value_text(node);
    rows += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", node.key,
                        value.size() <= kWidestCell ? fmt::format("`{}`", escape_cell(value)) : "a table",
                        escape_cell(node.unit), escape_cell(range_text(node)),
                        names_of(node.affects)[static_cast<std::size_t>(node.affects)], escape_cell(node.meaning));
  }
  if (!group.path.empty()) text += fmt::format("## {}\n\n{}\n\n", group.path, group.meaning);
  if (!rows.empty()) {
    text += "| key | default | unit | range | affects | meaning |\n|---|---|---|---|---|---|\n" + rows + "\n";
  }
  for (const ConfigNode& node : group.children) {
    if (node.is_group()) append_manual_of_group(node, text);
  }
}

}  // namespace

std::vector<FieldInfo> fields_of(const ConfigNode& root) {
  std::vector<FieldInfo> fields;
  collect_fields(root, fields);
  return fields;
}

Json json_of(const ConfigNode& root) {
  Json json = Json::object();
  for (const ConfigNode& node : root.children) json[node.key] = node.is_group() ? json_of(node) : value_json(node);
  json.sort_keys();
  return json;
}

std::string manual_of(const ConfigNode& root) {
  std::string text;
  append_manual_of_group(root, text);
  return text;
}

namespace {

/// Rewrites numbers such as 1e-05 as 1.0e-05, because YAML 1.1 parsers such as PyYAML read the first form as text.
std::string with_decimal_points(const std::string& text) {
  std::string out;
  bool is_whole = false;  // the number so far has digits and no decimal point
  for (const char c : text) {
    if (c == 'e' && is_whole) out += ".0";
    const bool begins = out.empty() || out.back() == ' ' || out.back() == '-';
    is_whole = c >= '0' && c <= '9' && (is_whole || begins);
    out += c;
  }
  return out;
}

/// Returns a field's value as in a configuration file. Words that YAML 1.1 parsers would read as booleans are quoted.
std::string yaml_value(const ConfigNode& field) {
  const std::string text = value_text(field);
  const FieldKind kind = field.kind();
  if (kind == FieldKind::kDouble || kind == FieldKind::kBand) return with_decimal_points(text);
  return kind == FieldKind::kEnum && yaml_boolean_of(text) ? double_quoted(text) : text;
}

class DumpWriter {
 public:
  DumpWriter(Comments comments, std::optional<Affects> only) : comments_(comments), only_(only) {}

  void write_group(const ConfigNode& parent, std::size_t depth) {
    for (const ConfigNode& node : parent.children) {
      if (!is_selected(node)) continue;
      write_node(node, depth);
      write_group(node, depth + 1);
    }
  }
  void write_node(const ConfigNode& node, std::size_t depth) {
    if (node.is_group()) {
      write_line(depth, node.key + ":", node.meaning);
    } else if (node.kind() == FieldKind::kBandMap) {
      write_map(node, depth);
    } else {
      // Hashes are computed from the text without comments, in which values are not quoted.
      write_line(depth, node.key + ": " + (comments_ == Comments::kOn ? yaml_value(node) : value_text(node)),
                 comment_of(node));
    }
  }
  std::string take_text() && { return std::move(text_); }

 private:
  bool is_selected(const ConfigNode& node) const {
    if (!only_) return true;
    if (!node.is_group()) return node.affects == *only_;
    return std::ranges::any_of(node.children, [this](const ConfigNode& child) { return is_selected(child); });
  }
  std::string comment_of(const ConfigNode& node) const {
    if (comments_ == Comments::kOff) return {};
    const FieldKind kind = node.kind();
    if (kind == FieldKind::kAutoCount && std::get<AutoCount*>(*node.target)->is_auto) {
      return fmt::format("{} here [{}] {}", std::get<AutoCount*>(*node.target)->value, node.unit, node.meaning);
    }
    const bool shown = kind == FieldKind::kFrequency || kind == FieldKind::kByteSize || kind == FieldKind::kDuration;
    return shown || node.unit.empty() ? node.meaning : fmt::format("[{}] {}", node.unit, node.meaning);
  }
  void write_map(const ConfigNode& node, std::size_t depth) {
    const auto& bands = *std::get<std::map<std::string, Band>*>(*node.target);
    write_line(depth, node.key + (bands.empty() ? ": {}" : ":"), comment_of(node));
    for (const auto& [name, band] : bands) {
      const std::string text = band_text(band);
      write_line(depth + 1,
                 fmt::format("{}: {}", key_text(name), comments_ == Comments::kOn ? with_decimal_points(text) : text),
                 {});
    }
  }
  void write_line(std::size_t depth, std::string_view content, std::string_view remark) {
    text_.append(2 * depth, ' ').append(content);
    if (comments_ == Comments::kOn && !remark.empty()) text_.append("  # ").append(remark);
    text_ += '\n';
  }

  Comments comments_;
  std::optional<Affects> only_;
  std::string text_;
};

}  // namespace

std::string dump_tree(const ConfigNode& root, Comments comments, std::optional<Affects> only) {
  DumpWriter dump(comments, only);
  dump.write_group(root, 0);
  return std::move(dump).take_text();
}

std::string dump_node(const ConfigNode& node, std::size_t depth, Comments comments) {
  DumpWriter dump(comments, {});
  dump.write_node(node, depth);
  return std::move(dump).take_text();
}

std::string hash_tree(const ConfigNode& root, std::optional<Affects> only) {
  return sha256_hex(dump_tree(root, Comments::kOff, only));
}

namespace {

/// Escapes characters that have a meaning in regular expressions.
std::string escape_regex(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (std::string_view("\\^$.|?*+()[]{}/").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

/// Returns the JSON Schema of a numeric field. The schema accepts a number, or a text with a number and the field's
/// unit.
Json number_schema(const ConfigNode& field, const char* type) {
  Json number = {{"type", type}};
  if (std::isfinite(field.limits.min)) number["minimum"] = field.limits.min;
  if (std::isfinite(field.limits.max)) number["maximum"] = field.limits.max;
  if (field.unit.empty()) return number;
  return {{"anyOf",
           {number, {{"type", "string"}, {"pattern", fmt::format("^[-+.0-9eE]+ +{}$", escape_regex(field.unit))}}}}};
}

Json quantity_schema(std::span<const MeasureUnit> units) {
  return {{"type", "string"}, {"pattern", fmt::format("^[0-9]+(\\.[0-9]+)? *({})$", names_of_units(units, "|"))}};
}

Json band_schema(const ConfigNode& field) {
  const Json number = number_schema(field, "number");
  const Json band = {{"type", "object"},
                     {"properties", {{"low", number}, {"nominal", number}, {"high", number}}},
                     {"required", {"low", "nominal", "high"}},
                     {"additionalProperties", false}};
  return {{"anyOf", {number, band}}};
}

/// Returns the JSON Schema of an enumeration. The schema accepts the names, and true or false for `on` or `off`, as
/// YAML 1.1 parsers read these words.
Json enum_schema(const std::vector<std::string_view>& names) {
  Json choices = names;
  for (const std::string_view name : names) {
    if (const std::optional<bool> boolean = yaml_boolean_of(name)) choices.push_back(*boolean);
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
    case FieldKind::kBand:
      return band_schema(field);
    case FieldKind::kBandMap:
      return {{"type", "object"}, {"additionalProperties", band_schema(field)}};
    case FieldKind::kEnum:
      return enum_schema(std::get<EnumTarget>(*field.target).names);
  }
  return {};
}

Json group_schema(const ConfigNode& group) {
  Json properties = {{"extends", {{"type", "string"}, {"description", "configuration file to start from"}}}};
  const bool has_bands = std::ranges::any_of(group.children, [](const ConfigNode& node) {
    return !node.is_group() && (node.kind() == FieldKind::kBand || node.kind() == FieldKind::kBandMap);
  });
  if (has_bands && group.find_child("scale") == nullptr) {
    properties["scale"] = {{"type", "object"}, {"description", "factors of values of the extended file"}};
  }
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
