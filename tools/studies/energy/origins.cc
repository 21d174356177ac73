#include "tools/studies/energy/origins.h"

#include <filesystem>

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

/// Files in the order in which they are laid upon each other.
class Layers {
 public:
  explicit Layers(std::map<std::string, std::string>& out) : out_(out) {}

  void file(const std::string& prefix, const fs::path& path) {
    const std::string text = sim::read_file(path, kLargestConfig);
    mapping(prefix, *sim::parse_yaml_mapping(text, path.string()), path, text);
  }

 private:
  void mapping(const std::string& prefix, const sim::YamlNode& node, const fs::path& path, const std::string& text) {
    if (const auto* base = node.find("extends"))
      file(prefix, sim::find_config(base->value->scalar, path.parent_path(), "extends", last_part(prefix)));
    for (const sim::YamlNode::Entry& entry : node.entries) {
      const std::string key = prefix.empty() ? entry.key : prefix + "." + entry.key;
      out_[key] = fmt::format("{}  ({}:{})", comment_of(text, entry.key_at.line), path.string(), entry.key_at.line);
      if (entry.value->kind == sim::YamlNode::Kind::kMapping) mapping(key, *entry.value, path, text);
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
  for (const std::string& set : sets) {
    const std::size_t equals = set.find('=');
    std::string key = set.substr(0, equals);
    for (const std::string end : {".nominal", ".extends"}) {
      if (key.ends_with(end)) key.resize(key.size() - end.size());
      if (set.substr(0, equals) == key + ".extends")
        layers.file(key, sim::find_config(set.substr(equals + 1), {}, set, last_part(key)));
    }
    out[key] = "--set " + set;
  }
  return out;
}

}  // namespace tools
