#pragma once
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/config_tree.h"
#include "sim/config/yaml_tree.h"

namespace sim {

/// Sets the folders in which configuration files are searched, in order. Call once, before any configuration is loaded.
void set_config_search_path(std::vector<std::filesystem::path> folders);

/// Returns the path of a configuration file, which `name` gives absolutely, relative to the folder `beside`, or
/// relative to a folder of the search path. ".yaml" is optional. Throws InputError if no file is found; the error
/// begins with `asked_at` and suggests the nearest file. `group`: the group of keys that refers to the file.
std::filesystem::path find_config(const std::filesystem::path& name, const std::filesystem::path& beside = {},
                                  std::string_view asked_at = {}, std::string_view group = {});

/// Reads configuration files and --set arguments into a bound configuration tree, one after the other. Each changes
/// only the fields that it mentions. Functions throw InputError.
class ConfigLoader {
 public:
  explicit ConfigLoader(ConfigNode& root) : root_(root) {}

  void apply_file(const std::filesystem::path& file) { apply_file(root_, file, {}); }
  /// Reads the names of bundles (TreeBuilder::bundle) from settings, before any file. The last setting counts.
  void choose_bundles(std::span<const std::string> sets);
  /// Reads a configuration file that may contain only the given keys at its top level.
  void apply_file_with_keys(const std::filesystem::path& file, std::span<const std::string_view> keys);
  /// Reads a configuration from YAML text, such as the output of dump_config. `name` identifies the text in errors.
  void apply_text(const std::string& text, const std::string& name);
  /// Applies one --set argument: "tni.trv.rays=16", "dram.extends=dram/lpddr3-1600" or "dram.energy.refresh={low: 1,
  /// nominal: 2, high: 3}".
  void apply_set(const std::string& argument);

 private:
  /// Where configuration values come from: a file, or a --set argument.
  struct Source {
    std::string name;
    std::filesystem::path folder;
    std::size_t nearness;  ///< ConfigNode::nearness
    bool is_file = true;
    std::string place_of(TextPosition position) const;
  };
  /// Name of a bundle, the place that chose it, and the folder that is searched first.
  struct ChosenBundle {
    std::string name, at;
    std::filesystem::path folder;
  };

  void apply_file(ConfigNode& group, const std::filesystem::path& file, std::string_view asked_at);
  void apply_mapping(ConfigNode& group, const YamlNode& mapping, const Source& source);
  void apply_extends(ConfigNode& group, const YamlNode& name, const Source& source, const std::string& at);
  void apply_scale(ConfigNode& group, const YamlNode& scale, const Source& source);
  /// Extends each group of a bundle by its file, once. The outermost file that names a bundle chooses it.
  void apply_bundle(ConfigNode& group, ConfigNode& node, const YamlNode& value, const Source& source,
                    const std::string& at);
  void apply_value(ConfigNode& node, const YamlNode& value, const Source& source, const std::string& at);
  void apply_band(const ConfigNode& field, const YamlNode& mapping, const Source& source, const std::string& at);

  ConfigNode& root_;
  std::span<const std::string_view> top_keys_;     ///< allowed keys of the files being read; empty: all
  std::vector<std::filesystem::path> open_files_;  ///< files being read; each is extended by the file before it
  std::size_t files_read_ = 0;
  bool is_complete_ = false;                     ///< the text has every key, so bundles extend nothing
  std::map<std::string, ChosenBundle> bundles_;  ///< by the bundle's path
};

}  // namespace sim
