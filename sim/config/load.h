#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/config_tree.h"
#include "sim/config/yaml_tree.h"

namespace sim {

/// Sets the folders in which configuration files are searched, in order. Call once, before any file is loaded.
void set_config_search_path(std::vector<std::filesystem::path> folders);

/// Resolves a configuration name: an absolute path, relative to `beside`, or on the search path. ".yaml" is optional.
/// `group` is the group of keys that refers to the file. InputError, prefixed with `asked_at`, if no file is found; it
/// names the nearest file.
std::filesystem::path find_config(const std::filesystem::path& name, const std::filesystem::path& beside = {},
                                  std::string_view asked_at = {}, std::string_view group = {});

/// Reads configuration files and --set arguments into a bound tree. Each layer changes only the fields that it
/// mentions. Throws InputError.
class ConfigLoader {
 public:
  explicit ConfigLoader(ConfigNode& root) : root_(root) {}

  void apply_file(const std::filesystem::path& file) { apply_file(root_, file, {}); }
  /// Reads a file that may contain only these keys at its top level.
  void apply_file_with_keys(const std::filesystem::path& file, std::span<const std::string_view> keys);
  /// Reads the output of dump_config. `name` identifies it in errors.
  void apply_text(const std::string& text, const std::string& name);
  /// Applies "tni.trv.rays=16", "dram.extends=dram/lpddr3-1600" or "dram.energy.refresh={low: 1, nominal: 2, high: 3}".
  void apply_set(const std::string& argument);

 private:
  /// Origin of a layer: a file's name, or the whole --set argument.
  struct Source {
    std::string name;
    std::filesystem::path folder;
    std::size_t nearness;  ///< ConfigNode::nearness
    bool is_file = true;
    std::string place_of(TextPosition position) const;
  };

  void apply_file(ConfigNode& group, const std::filesystem::path& file, std::string_view asked_at);
  void apply_mapping(ConfigNode& group, const YamlNode& mapping, const Source& source);
  void apply_extends(ConfigNode& group, const YamlNode& name, const Source& source, const std::string& at);
  void apply_value(ConfigNode& node, const YamlNode& value, const Source& source, const std::string& at);
  void apply_band(const ConfigNode& field, const YamlNode& mapping, const Source& source, const std::string& at);

  ConfigNode& root_;
  std::span<const std::string_view> top_keys_;     ///< allowed keys of the files being read; empty: all
  std::vector<std::filesystem::path> open_files_;  ///< each is extended by the file before it
  std::size_t files_read_ = 0;
};

}  // namespace sim
