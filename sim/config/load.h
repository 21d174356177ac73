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

/// Sets the folders in which configuration files are searched, the first one first. Call once, before any configuration
/// is loaded.
void set_config_search_path(std::vector<std::filesystem::path> folders);

/// Finds a configuration file. `name`: path, absolute or relative to the folder `beside` or to a folder of the search
/// path; ".yaml" is optional. `group`: the group of keys that refers to the file. Throws InputError if no file is
/// found; its text begins with `asked_at` and suggests the nearest file.
std::filesystem::path find_config(const std::filesystem::path& name, const std::filesystem::path& beside = {},
                                  std::string_view asked_at = {}, std::string_view group = {});

/// Reads configuration files and --set arguments, one after another, into a configuration tree. Each file or argument
/// changes only the fields that it contains. Functions throw InputError.
class ConfigLoader {
 public:
  explicit ConfigLoader(ConfigNode& root) : root_(root) {}

  void apply_file(const std::filesystem::path& file) { apply_file(root_, file, {}); }
  /// Reads the values of bundle fields, such as `process`, from --set arguments (TreeBuilder::bundle_choice). Call
  /// before files are read. If a field is set several times, the last value counts.
  void read_bundle_choices(std::span<const std::string> sets);
  /// Reads a configuration file that may contain only the given keys at its top level.
  void apply_file_with_keys(const std::filesystem::path& file, std::span<const std::string_view> keys);
  /// Reads a configuration from YAML text, such as the output of dump_config. `name` identifies the text in errors.
  void apply_text(const std::string& text, const std::string& name);
  /// Applies one --set argument: "tni.trv.rays=16", "dram.extends=dram/lpddr3-1600" or "dram.energy.refresh={low: 1,
  /// nominal: 2, high: 3}".
  void apply_set(const std::string& argument);

 private:
  /// Source of configuration values: a file, or a --set argument.
  struct Source {
    std::string name;
    std::filesystem::path folder;
    std::size_t nearness;  ///< value for ConfigNode::nearness of the fields that the source sets
    bool is_file = true;
    std::string location_text(TextPosition position) const;
  };
  /// Value of a bundle field such as `process` (TreeBuilder::bundle_choice), where it was set, and the folder in which
  /// the bundle's files are searched first.
  struct ChosenBundle {
    std::string name, at;
    std::filesystem::path folder;
  };

  void apply_file(ConfigNode& group, const std::filesystem::path& file, std::string_view asked_at);
  void apply_mapping(ConfigNode& group, const YamlNode& mapping, const Source& source);
  void apply_extends(ConfigNode& group, const YamlNode& name, const Source& source, const std::string& at);
  void apply_scale(ConfigNode& group, const YamlNode& scale, const Source& source);
  /// Makes each group of a bundle extend the file that the bundle field names, such as `process: 5nm`
  /// (TreeBuilder::bundle_choice). The first call decides: if several files set the field, the outermost one counts.
  void apply_bundle(ConfigNode& group, ConfigNode& node, const YamlNode& value, const Source& source,
                    const std::string& at);
  void apply_value(ConfigNode& node, const YamlNode& value, const Source& source, const std::string& at);
  void apply_band(const ConfigNode& field, const YamlNode& mapping, const Source& source, const std::string& at);

  ConfigNode& root_;
  std::span<const std::string_view> top_keys_;     ///< allowed keys of the files being read; empty: all
  std::vector<std::filesystem::path> open_files_;  ///< files being read; each file extends the next one
  std::size_t files_read_ = 0;
  bool is_complete_ = false;                     ///< the text contains every key, so bundles read no files
  std::map<std::string, ChosenBundle> bundles_;  ///< chosen bundles, by the path of the bundle field
};

}  // namespace sim
