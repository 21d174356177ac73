#include "sim/config/describe.h"

#include <fmt/format.h>

#include "sim/config/value.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

void collect(const ConfigNode& group, std::vector<FieldInfo>& fields) {
  for (const ConfigNode& node : group.children) {
    if (node.is_group()) {
      collect(node, fields);
      continue;
    }
    FieldInfo info{node.path, node.kind(), node.unit, node.meaning, node.limits, node.affects, value_text(node), {}};
    if (const auto* choice = std::get_if<EnumTarget>(&*node.target)) {
      info.choices.assign(choice->names.begin(), choice->names.end());
    }
    fields.push_back(std::move(info));
  }
}

Json spread_json(const Spread& spread) {
  return {{"low", spread.low}, {"nominal", spread.nominal}, {"high", spread.high}};
}

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
    case FieldKind::kSpread:
      return spread_json(*std::get<Spread*>(*field.target));
    case FieldKind::kSpreadMap: {
      Json map = Json::object();
      for (const auto& [name, spread] : *std::get<std::map<std::string, Spread>*>(*field.target)) {
        map[name] = spread_json(spread);
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

/// Escapes '|', which ends a table cell.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

constexpr std::size_t kWidestCell = 100;  // longer values, such as large maps, are left to `config show`

void manual_group(const ConfigNode& group, std::string& text) {
  std::string rows;
  for (const ConfigNode& node : group.children) {
    if (node.is_group()) continue;
    const std::string value = value_text(node);
    rows += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", node.key,
                        value.size() <= kWidestCell ? fmt::format("`{}`", cell(value)) : "a table", cell(node.unit),
                        cell(allowed_text(node)), names_of(node.affects)[static_cast<std::size_t>(node.affects)],
                        cell(node.meaning));
  }
  if (!group.path.empty()) text += fmt::format("## {}\n\n{}\n\n", group.path, group.meaning);
  if (!rows.empty()) {
    text += "| key | default | unit | range | affects | meaning |\n|---|---|---|---|---|---|\n" + rows + "\n";
  }
  for (const ConfigNode& node : group.children) {
    if (node.is_group()) manual_group(node, text);
  }
}

}  // namespace

std::vector<FieldInfo> fields_of(const ConfigNode& root) {
  std::vector<FieldInfo> fields;
  collect(root, fields);
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
  manual_group(root, text);
  return text;
}

}  // namespace sim
