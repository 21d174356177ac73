#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/config_tree.h"
#include "sim/config/describe.h"
#include "sim/config/field.h"
#include "sim/config/load.h"
#include "sim/io/json.h"

namespace sim {

/// Applies --set arguments such as "a.b=c" to a configuration, then checks it. Throws InputError that names the
/// argument.
template <class Config>
void apply_sets(Config& config, std::span<const std::string> sets) {
  ConfigNode tree = config_tree(config);
  ConfigLoader loader(tree);
  for (const std::string& argument : sets) loader.apply_set(argument);
  check_tree(tree);
}

/// Reads a configuration file and the files that it `extends`, applies --set arguments such as "a.b=c", then checks the
/// result. Throws InputError with a one-line text: file, line and column (or the --set argument), key, problem, and
/// what is allowed.
template <class Config>
Config load_config(const std::filesystem::path& file, std::span<const std::string> sets = {}) {
  Config config;
  ConfigNode tree = config_tree(config);
  ConfigLoader loader(tree);
  loader.read_bundle_choices(sets);
  loader.apply_file(file);
  for (const std::string& argument : sets) loader.apply_set(argument);
  check_tree(tree, file.string());
  return config;
}

/// Checks every value of a configuration against its limits, then the rules that involve several values. Throws
/// InputError that names the key.
template <class Config>
void check_config(const Config& config) {
  Config copy = config;
  check_tree(config_tree(copy));
}

/// Returns a configuration as YAML text with every field, and its unit and meaning as a comment. Loading the text
/// restores the configuration.
template <class Config>
std::string dump_config(const Config& config) {
  Config copy = config;
  return dump_tree(config_tree(copy), Comments::kOn);
}

/// Returns the SHA-256 hash of a configuration's values. `only`: if given, only fields with this Affects value are
/// hashed.
template <class Config>
std::string config_hash(const Config& config, std::optional<Affects> only = {}) {
  Config copy = config;
  return hash_tree(config_tree(copy), only);
}

/// Returns the manual of a configuration as Markdown: a table for each group, with key, value in `config`, unit, range,
/// what the key affects, and meaning.
template <class Config>
std::string config_manual(const Config& config) {
  Config copy = config;
  return manual_of(config_tree(copy));
}

/// Returns a description of every field of a configuration, with its value in `config`, in the order of declaration.
template <class Config>
std::vector<FieldInfo> list_fields(const Config& config) {
  Config copy = config;
  return fields_of(config_tree(copy));
}

/// Returns a JSON Schema (draft 2020-12) for configuration files of this type.
template <class Config>
Json config_schema() {
  Config defaults;
  return schema_of(config_tree(defaults));
}

/// Returns a configuration as nested JSON objects. Numbers are JSON numbers; quantities are texts as in a file ("500
/// MHz").
template <class Config>
Json config_json(const Config& config) {
  Config copy = config;
  return json_of(config_tree(copy));
}

}  // namespace sim
