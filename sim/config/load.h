#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/config_tree.h"
#include "sim/config/yaml_tree.h"

namespace sim {

/// Folders in which a configuration is looked up that is not found beside the file that names it, first come first.
/// Set once, before any file is loaded.
void set_config_search_path(std::vector<std::filesystem::path> folders);

/// The file a configuration's name means: the name as it is if absolute, else below `beside`, else below a folder of
/// the search path; ".yaml" may be left out. InputError, with `asked_at` in front, if there is none,
/// and the nearest name in the folder that is called as the `group` of keys that asks.
std::filesystem::path find_config(const std::filesystem::path& name, const std::filesystem::path& beside = {},
                                  std::string_view asked_at = {}, std::string_view group = {});

/// Reads configuration files and --set arguments into a bound tree, one layer upon the other: what a layer does not
/// mention stays as it was. Throws InputError.
class ConfigLoader {
 public:
  explicit ConfigLoader(ConfigNode& root) : root_(root) {}

  void apply_file(const std::filesystem::path& file) { apply_file(root_, file, {}); }
  /// A file that may have these keys at its top level alone.
  void apply_part(const std::filesystem::path& file, std::span<const std::string_view> keys);
  /// A configuration as dump_config writes it; `name` is how errors call it.
  void apply_text(const std::string& text, const std::string& name);
  /// "tni.trv.rays=16", "dram.extends=dram/lpddr3-1600", "dram.energy.refresh={low: 1, nominal: 2, high: 3}"
  void apply_set(const std::string& argument);

 private:
  /// Where a layer comes from: a file's name, or the whole --set argument.
  struct Source {
    std::string name;
    std::filesystem::path folder;
    std::size_t nearness;  ///< ConfigNode::nearness
    bool is_file = true;
    std::string at(TextPosition position) const;
  };

  void apply_file(ConfigNode& group, const std::filesystem::path& file, std::string_view asked_at);
  void apply_mapping(ConfigNode& group, const YamlNode& mapping, const Source& source);
  void apply_extends(ConfigNode& group, const YamlNode& name, const Source& source, const std::string& at);
  void apply_value(ConfigNode& node, const YamlNode& value, const Source& source, const std::string& at);
  void apply_spread(const ConfigNode& field, const YamlNode& mapping, const Source& source, const std::string& at);

  ConfigNode& root_;
  std::span<const std::string_view> top_keys_;     ///< keys of the files being read; empty: all
  std::vector<std::filesystem::path> open_files_;  ///< each extended by the one before it
  std::size_t files_read_ = 0;
};

}  // namespace sim
