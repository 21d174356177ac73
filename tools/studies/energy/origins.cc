#include "tools/studies/energy/origins.h"

#include <filesystem>
#include <functional>

#include <fmt/format.h>

#include "sim/config/load.h"
#include "sim/io/file.h"
#include "tools/host/paths.h"

namespace tools {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestConfig = 4 << 20;

/// Words of a line's comment, without "source:".
std::string comment_of(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
  const std::string whole = text.substr(begin, text.find('\n', begin) - begin);
  const std::size_t comment = whole.find("# ");
  if (comment == std::string::npos) return "no comment";
  const std::string said = whole.substr(comment + 2);
  return said.starts_with("source: ") ? said.substr(8) : said;
}

/// The group that a path ends in.
std::string last_part(const std::string& path) { return path.substr(path.rfind('.') + 1); }

/// Files and settings in the order in which they are laid upon each other.
class Layers {
 public:
  explicit Layers(std::map<std::string, std::string>& out) : out_(out) {}

  void file(const std::string& prefix, const fs::path& path) {
    const std::string text = sim::read_file(path, kLargestConfig);
    mapping(prefix, *sim::parse_yaml_mapping(text, path.string()), path.parent_path(),
            [&](int line) { return fmt::format("{}  ({}:{})", comment_of(text, line), path.string(), line); });
  }

  /// "KEY=VALUE", where a value in braces gives several keys.
  void set(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string value = text.substr(equals + 1), origin = "--set " + text;
    std::string key = text.substr(0, equals);
    for (const std::string end : {".nominal", ".extends"}) {
      if (key.ends_with(end)) key.resize(key.size() - end.size());
      if (text.substr(0, equals) == key + ".extends") file(key, sim::find_config(value, {}, text, last_part(key)));
    }
    if (value.starts_with('{')) {
      mapping(key, *sim::parse_yaml_mapping(value, origin), {}, [&](int) { return origin; });
    }
    out_[key] = origin;
  }

 private:
  /// `origin` of a line.
  void mapping(const std::string& prefix, const sim::YamlNode& node, const fs::path& folder,
               const std::function<std::string(int)>& origin) {
    if (const auto* base = node.find("extends"))
      file(prefix, sim::find_config(base->value->scalar, folder, "extends", last_part(prefix)));
    for (const sim::YamlNode::Entry& entry : node.entries) {
      const std::string key = prefix.empty() ? entry.key : prefix + "." + entry.key;
      out_[key] = origin(entry.key_at.line);
      if (entry.value->kind == sim::YamlNode::Kind::kMapping) mapping(key, *entry.value, folder, origin);
    }
  }

  std::map<std::string, std::string>& out_;
};

}  // namespace

std::map<std::string, std::string> config_origins(const std::string& config, const std::vector<std::string>& sets) {
  sim::set_config_search_path(config_folders());
  std::map<std::string, std::string> out;
  Layers layers(out);
  layers.file("", find_config(config));
  for (const std::string& set : sets) layers.set(set);
  return out;
}

}  // namespace tools
