#include "sim/config/load.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/scale.h"
#include "sim/config/value.h"
#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"

namespace sim {
namespace {

constexpr std::uint64_t kMostBytes = 4 << 20;
constexpr std::size_t kMostFilesDeep = kNearestFile;
constexpr std::size_t kMostFiles = 256;
constexpr std::string_view kExtends = "extends", kScale = "scale";
/// Configuration keys of the three numbers of a Band. A single number instead of the keys sets all three.
constexpr std::string_view kNominal = "nominal", kLow = "low", kHigh = "high";

std::vector<std::filesystem::path>& search_path() {
  static std::vector<std::filesystem::path> folders;
  return folders;
}

/// Returns the names of the configuration files in the folders of the search path and their subfolders, as written in
/// `extends`: "dram/lpddr3-1600".
std::vector<std::filesystem::path> known_files() {
  std::vector<std::filesystem::path> files;
  std::error_code missing;
  const auto add = [&](const std::filesystem::path& folder, const std::filesystem::path& below) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / below, missing)) {
      if (entry.path().extension() == ".yaml") files.push_back(below / entry.path().stem());
    }
  };
  for (const std::filesystem::path& folder : search_path()) {
    add(folder, {});
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
      if (entry.is_directory(missing)) add(folder, entry.path().filename());
    }
  }
  std::ranges::sort(files);
  return files;
}

/// Returns a hint for a configuration file that was not found: "; did you mean 'dram/lpddr3-1600'?" if a similar name
/// exists, and "; known: ..." with the files for `group`.
std::string known_files_hint(const std::filesystem::path& name, std::string_view group) {
  const std::string stem = name.stem().string();
  const std::string_view start = comparison_prefix(stem);
  auto files = known_files();
  std::erase_if(files, [&](const std::filesystem::path& file) { return file.parent_path() != group; });
  const auto found = find_nearest(start, files, start.size() / 2,
                                  [](const std::filesystem::path& file) { return file.stem().string(); });
  std::string text = found == files.end() ? "" : fmt::format("; did you mean '{}'?", found->string());
  if (files.empty()) return text;
  std::vector<std::string> stems;
  for (const std::filesystem::path& file : files) stems.push_back(file.stem().string());
  return text + fmt::format("; known: {}; or a path to a .yaml file", fmt::join(stems, ", "));
}

std::string_view first_key(std::string_view path) { return path.substr(0, path.find('.')); }

std::string path_of(const ConfigNode& group, std::string_view key) {
  return group.path.empty() ? std::string(key) : fmt::format("{}.{}", group.path, key);
}

/// Returns a dotted key in nested YAML form: "tni: {trv: {rays: ...}}" for "tni.trv.rays".
std::string nested_form(std::string_view key) {
  std::string text, ends;
  for (std::size_t dot = key.find('.'); dot != std::string_view::npos; dot = key.find('.')) {
    text += fmt::format("{}: {{", key.substr(0, dot));
    ends += '}';
    key.remove_prefix(dot + 1);
  }
  return fmt::format("{}{}: ...{}", text, key, ends);
}

std::string unknown_key_error(const ConfigNode& root, const ConfigNode& group, std::string_view key) {
  if (const auto absent = group.not_modelled.find(key); absent != group.not_modelled.end()) {
    return fmt::format("is not modelled: {} (docs/design/not-modelled.md)", absent->second);
  }
  if (key.find('.') != std::string_view::npos && group.find_child(first_key(key)) != nullptr) {
    return fmt::format("unknown key '{}'; allowed: {}", key, nested_form(key));
  }
  return fmt::format("unknown key '{}'; {}", key, suggest_keys(root, group, key));
}

/// Returns an entry of a map of values as a separate configuration field. Adds the entry if it is absent.
ConfigNode map_entry(const ConfigNode& map, std::string_view key) {
  ConfigNode field = map;
  field.path = path_of(map, key);
  field.target = &(*std::get<std::map<std::string, Band>*>(*map.target))[std::string(key)];
  return field;
}

/// Normalises the part of a --set path after the path of the field `node`. Omits a final "nominal" of a Band, because a
/// single number sets low, nominal and high. Throws InputError for a final "low" or "high", which cannot be set alone.
std::string_view path_after_field(const ConfigNode& node, std::string_view path, const std::string& at) {
  const std::size_t dot = path.rfind('.');
  const std::string_view last = path.substr(dot == std::string_view::npos ? 0 : dot + 1);
  const std::string_view entry = dot == std::string_view::npos ? std::string_view() : path.substr(0, dot);
  const bool is_band =
      node.kind() == FieldKind::kBandMap ? !entry.empty() : node.kind() == FieldKind::kBand && entry.empty();
  if (is_band && (last == kLow || last == kHigh)) {
    refuse(at, path_of(node, path),
           "is a part of a band; allowed: one number, which leaves no band, or all of {low: 1, nominal: 2, high: 3}");
  }
  return is_band && last == kNominal ? entry : path;
}

/// Parses the text after '=' of a --set argument: a mapping in braces, a text in double quotes, or plain text.
std::shared_ptr<const YamlNode> parse_set_value(const std::string& text, const std::string& name) {
  if (text.starts_with('{')) return parse_yaml_mapping(text, name);
  if (text.starts_with('"')) return parse_yaml_mapping("value: " + text, name)->entries.front().value;
  const auto value = std::make_shared<YamlNode>();
  value->kind = YamlNode::Kind::kScalar;
  value->scalar = text;
  return value;
}

}  // namespace

void set_config_search_path(std::vector<std::filesystem::path> folders) { search_path() = std::move(folders); }

std::filesystem::path find_config(const std::filesystem::path& name, const std::filesystem::path& beside,
                                  std::string_view asked_at, std::string_view group) {
  std::vector<std::filesystem::path> folders = {beside};
  if (name.is_relative()) folders.insert(folders.end(), search_path().begin(), search_path().end());
  std::vector<std::filesystem::path> names = {name};
  if (!group.empty() && name.is_relative() && !name.has_parent_path()) names.push_back(group / name);
  for (const std::filesystem::path& wanted : names) {
    for (const std::filesystem::path& folder : folders) {
      for (const char* extension : {"", ".yaml"}) {
        std::filesystem::path file = folder / wanted;
        file += extension;
        std::error_code failed;
        if (std::filesystem::is_regular_file(file, failed)) return file.lexically_normal();
      }
    }
  }
  refuse(asked_at, {}, fmt::format("no configuration file '{}'{}", name.string(), known_files_hint(name, group)));
}

std::string ConfigLoader::Source::location_text(TextPosition position) const {
  return is_file ? fmt::format("{}:{}:{}", name, position.line, position.column) : name;
}

void ConfigLoader::apply_file(ConfigNode& group, const std::filesystem::path& file, std::string_view asked_at) {
  std::error_code failed;
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(file, failed);
  if (std::ranges::find(open_files_, canonical) != open_files_.end()) {
    refuse(asked_at, {}, fmt::format("'{}' extends itself", file.string()));
  }
  if (open_files_.size() == kMostFilesDeep) {
    refuse(asked_at, {}, fmt::format("more than {} files extend each other", kMostFilesDeep));
  }
  if (++files_read_ > kMostFiles) refuse(asked_at, {}, fmt::format("more than {} files are extended", kMostFiles));
  const Source source{printable(file.string()), file.parent_path(), kNearestFile - open_files_.size()};
  const auto mapping = parse_yaml_mapping(read_file(file, kMostBytes), source.name);
  open_files_.push_back(canonical);
  apply_mapping(group, *mapping, source);
  open_files_.pop_back();
}

void ConfigLoader::read_bundle_choices(std::span<const std::string> sets) {
  for (const std::string& set : sets) {
    const std::size_t equals = std::min(set.find('='), set.size());
    const ConfigNode* node = root_.find_child(std::string_view(set).substr(0, equals));
    if (node == nullptr || node->bundle.empty() || equals + 1 >= set.size()) continue;
    const std::string at = std::string(kSetOrigin) + printable(set);
    bundles_[node->path] = {parse_set_value(set.substr(equals + 1), at)->scalar, at, {}};
  }
}

void ConfigLoader::apply_file_with_keys(const std::filesystem::path& file, std::span<const std::string_view> keys) {
  top_keys_ = keys;
  apply_file(file);
  top_keys_ = {};
}

void ConfigLoader::apply_text(const std::string& text, const std::string& name) {
  is_complete_ = true;
  apply_mapping(root_, *parse_yaml_mapping(text, name), {name, {}, kNearestFile});
  is_complete_ = false;
}

void ConfigLoader::apply_mapping(ConfigNode& group, const YamlNode& mapping, const Source& source) {
  const auto each_bundle = [&](auto&& use) {
    for (ConfigNode& node : group.children) {
      if (node.bundle.empty() || is_complete_) continue;
      if (const YamlNode::Entry* entry = mapping.find(node.key)) use(node, *entry);
    }
  };
  each_bundle([&](const ConfigNode& node, const YamlNode::Entry& entry) {
    bundles_.try_emplace(node.path,
                         ChosenBundle{entry.value->scalar, source.location_text(entry.value_at), source.folder});
  });
  const YamlNode::Entry* base = mapping.find(kExtends);
  if (base != nullptr) apply_extends(group, *base->value, source, source.location_text(base->value_at));
  if (const YamlNode::Entry* scale = mapping.find(kScale); scale != nullptr && group.find_child(kScale) == nullptr) {
    if (base == nullptr) {
      refuse(source.location_text(scale->key_at), path_of(group, kScale),
             "multiplies figures of the file that is extended; allowed: after 'extends'");
    }
    apply_scale(group, *scale->value, source);
  }
  each_bundle([&](ConfigNode& node, const YamlNode::Entry& entry) {
    apply_bundle(group, node, *entry.value, source, source.location_text(entry.value_at));
  });
  for (const YamlNode::Entry& entry : mapping.entries) {
    if (entry.key == kExtends || (entry.key == kScale && group.find_child(kScale) == nullptr)) continue;
    ConfigNode* node = group.find_child(entry.key);
    const bool fits = &group != &root_ || top_keys_.empty() || std::ranges::count(top_keys_, entry.key) != 0;
    if (node != nullptr && !fits) {
      refuse(source.location_text(entry.key_at), entry.key,
             fmt::format("does not belong into such a file; allowed: {}", fmt::join(top_keys_, ", ")));
    }
    if (node == nullptr) {
      refuse(source.location_text(entry.key_at), path_of(group, entry.key), unknown_key_error(root_, group, entry.key));
    }
    node->origin = source.location_text(entry.key_at);
    node->nearness = source.nearness;
    if (!node->bundle.empty() && !is_complete_) continue;
    apply_value(*node, *entry.value, source, source.location_text(entry.value_at));
  }
}

void ConfigLoader::apply_extends(ConfigNode& group, const YamlNode& name, const Source& source, const std::string& at) {
  if (name.kind != YamlNode::Kind::kScalar || name.scalar.empty()) {
    refuse(at, path_of(group, kExtends), "allowed: the name of a configuration file");
  }
  const std::string asked_at = fmt::format("{}: {}", at, path_of(group, kExtends));
  apply_file(group, find_config(name.scalar, source.folder, asked_at, group.key), asked_at);
}

void ConfigLoader::apply_scale(ConfigNode& group, const YamlNode& scale, const Source& source) {
  BandScale factors;
  for (const YamlNode::Entry& entry : scale.entries) {
    Band factor;
    ConfigNode field;
    field.path = path_of(group, fmt::format("{}.{}", kScale, entry.key));
    field.target = &factor;
    field.limits = at_least(0);
    apply_value(field, *entry.value, source, source.location_text(entry.value_at));
    factors.add(entry.key, factor);
  }
  const std::string unused = factors.apply(group);
  if (scale.entries.empty() || !unused.empty()) {
    refuse(source.name, path_of(group, fmt::format("{}.{}", kScale, unused)),
           "covers no figure; allowed: a figure's key, or the first parts of its name, e.g. events.cache");
  }
}

void ConfigLoader::apply_bundle(ConfigNode& group, ConfigNode& node, const YamlNode& value, const Source& source,
                                const std::string& at) {
  if (value.kind != YamlNode::Kind::kScalar || value.scalar.empty()) {
    refuse(at, node.path, fmt::format("allowed: a name that files of {} have", fmt::join(node.bundle, ", ")));
  }
  const ChosenBundle& chosen =
      bundles_.try_emplace(node.path, ChosenBundle{value.scalar, at, source.folder}).first->second;
  std::string& member = *std::get<std::string*>(*node.target);
  if (member == chosen.name) return;
  const std::string asked_at = fmt::format("{}: {}", chosen.at, node.path);
  for (const std::string& key : node.bundle) {
    const std::filesystem::path file = std::filesystem::path(key) / chosen.name;
    apply_file(*group.find_child(key), find_config(file, chosen.folder, asked_at, key), asked_at);
  }
  member = chosen.name;
}

void ConfigLoader::apply_value(ConfigNode& node, const YamlNode& value, const Source& source, const std::string& at) {
  const bool is_mapping = value.kind == YamlNode::Kind::kMapping;
  if (node.is_group()) {
    if (!is_mapping) refuse(at, node.path, "is a group of fields; allowed: a mapping");
    return apply_mapping(node, value, source);
  }
  if (node.kind() == FieldKind::kBand && is_mapping) return apply_band(node, value, source, at);
  if (node.kind() == FieldKind::kBandMap && is_mapping) {
    for (const YamlNode::Entry& entry : value.entries) {
      ConfigNode field = map_entry(node, entry.key);
      apply_value(field, *entry.value, source, source.location_text(entry.value_at));
    }
    return;
  }
  if (value.kind == YamlNode::Kind::kSequence) {
    refuse(at, node.path,
           fmt::format("is a list; allowed: one value, {}; lists are for axes of a sweep (docs/sweeps.md)",
                       allowed_text(node)));
  }
  if (value.kind != YamlNode::Kind::kScalar) {
    refuse(at, node.path, fmt::format("has no value; allowed: {}", allowed_text(node)));
  }
  try {
    parse_value(node, value.scalar);
  } catch (const BadValue& bad) {
    refuse(at, node.path, bad.problem);
  }
  if (const std::string problem = value_problem(node); !problem.empty()) refuse(at, node.path, problem);
}

void ConfigLoader::apply_band(const ConfigNode& field, const YamlNode& mapping, const Source& source,
                              const std::string& at) {
  Band& band = *std::get<Band*>(*field.target);
  const std::map<std::string_view, double*> parts{{"low", &band.low}, {"nominal", &band.nominal}, {"high", &band.high}};
  for (const YamlNode::Entry& entry : mapping.entries) {
    const std::string path = path_of(field, entry.key);
    const auto part = parts.find(entry.key);
    if (part == parts.end())
      refuse(source.location_text(entry.key_at), path, "unknown key; allowed: low, nominal, high");
    try {
      *part->second = parse_number(field, entry.value->scalar);
    } catch (const BadValue& bad) {
      refuse(source.location_text(entry.value_at), path, bad.problem);
    }
  }
  if (mapping.entries.size() != parts.size()) refuse(at, field.path, "is incomplete; allowed: low, nominal and high");
  if (const std::string problem = value_problem(field); !problem.empty()) refuse(at, field.path, problem);
}

void ConfigLoader::apply_set(const std::string& argument) {
  const Source source{std::string(kSetOrigin) + printable(argument), {}, kNearestFile + 1, false};
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0) refuse(source.name, {}, "allowed: key=value, e.g. --set cores=2");
  const auto value = parse_set_value(argument.substr(equals + 1), source.name);
  ConfigNode* node = &root_;
  std::string_view path = std::string_view(argument).substr(0, equals);
  while (node->is_group() && !path.empty()) {
    const std::string_view key = first_key(path);
    if (path == kExtends) return apply_extends(*node, *value, source, source.name);
    ConfigNode* child = node->find_child(key);
    if (child == nullptr) refuse(source.name, path_of(*node, key), unknown_key_error(root_, *node, key));
    if (!child->bundle.empty() && path == key) apply_bundle(*node, *child, *value, source, source.name);
    node = child;
    node->origin = source.name;
    node->nearness = source.nearness;
    path.remove_prefix(std::min(path.size(), key.size() + 1));
  }
  if (path.empty() && !node->bundle.empty()) return;
  if (path.empty()) return apply_value(*node, *value, source, source.name);
  const bool is_map = node->kind() == FieldKind::kBandMap;
  const std::string_view rest = path_after_field(*node, path, source.name);
  if (is_map) {
    ConfigNode field = map_entry(*node, rest);
    return apply_value(field, *value, source, source.name);
  }
  if (rest.empty()) return apply_value(*node, *value, source, source.name);
  refuse(source.name, path_of(*node, path), fmt::format("'{}' is one value, without keys inside", node->path));
}

}  // namespace sim
