#include "sim/config/config.h"

#include <set>

#include <gtest/gtest.h>

#include "sim/config/yaml_tree.h"
#include "sim/io/file.h"
#include "tests/structure/repository.h"
#include "tools/run/frame/load_config.h"

// Tests that every number of the default machine is in a configuration file and has its source in a comment.

namespace test {
namespace {

namespace fs = std::filesystem;
using Kind = sim::YamlNode::Kind;

constexpr std::uint64_t kMostBytes = 1 << 20;

/// A value in a configuration file: its key path within the file, and its line.
struct Given {
  std::string path;
  std::string line;
  std::string where;  ///< "file:line"
};

/// True if a mapping is one value with a band, {low, nominal, high}.
bool is_band(const sim::YamlNode& node) { return node.find("nominal") != nullptr; }

void collect(const sim::YamlNode& mapping, const std::string& above, const fs::path& file,
             const std::vector<std::string>& lines, std::vector<Given>& given) {
  for (const sim::YamlNode::Entry& entry : mapping.entries) {
    const std::string path = above.empty() ? entry.key : above + "." + entry.key;
    if (entry.value->kind == Kind::kMapping && !is_band(*entry.value)) {
      collect(*entry.value, path, file, lines, given);
    } else {
      const auto line = static_cast<std::size_t>(entry.key_at.line);
      given.push_back({path, lines.at(line - 1), file.string() + ":" + std::to_string(line)});
    }
  }
}

std::vector<Given> given_in(const fs::path& file) {
  std::vector<Given> given;
  collect(*sim::parse_yaml_mapping(sim::read_file(repository() / file, kMostBytes), file.string()), "", file,
          lines_of(file), given);
  return given;
}

bool ends_with_key(const std::string& path, const std::string& key) { return path == key || path.ends_with("." + key); }

/// Adds the key paths of all values in a file, and in the files that it extends, to `paths`. `above`: their prefix.
void add_given(const fs::path& file, const std::string& above, std::set<std::string>& paths) {
  for (const Given& value : given_in(file)) {
    const std::string path = above + value.path;
    paths.insert(path);
    if (above.empty() && path == "process") {
      for (const std::string table : {"energy", "area", "power", "latency"}) {
        add_given(fs::path("configs") / table / "14nm.yaml", table + ".", paths);
      }
    }
    if (!ends_with_key(path, "extends")) continue;
    const std::size_t colon = value.line.find(':');
    const std::string name = value.line.substr(value.line.find_first_not_of(' ', colon + 1));
    add_given((file.parent_path() / name).lexically_normal(),
              path.substr(0, path.size() - std::string("extends").size()), paths);
  }
}

std::vector<fs::path> yaml_files() {
  std::vector<fs::path> files;
  for (const fs::path& file : repository_files()) {
    if ((file.string().starts_with("configs/") || file.string().starts_with("traces/workloads/")) &&
        !file.string().starts_with("configs/experiments/") &&  // sweeps, which have no values of a machine
        !file.string().starts_with("configs/worth/") && file.extension() == ".yaml") {
      files.push_back(file);
    }
  }
  return files;
}

TEST(Configs, EveryValueSaysItsSource) {
  ASSERT_GE(yaml_files().size(), 6U);
  for (const fs::path& file : yaml_files()) {
    for (const Given& value : given_in(file)) {
      if (ends_with_key(value.path, "extends") || value.path == "process" || value.path == "scene.name" ||
          value.path == "scene.camera") {
        continue;  // names, not numbers
      }
      EXPECT_NE(value.line.find("  # source: "), std::string::npos) << value.where << ": " << value.path;
    }
  }
}

TEST(Configs, TheDefaultMachineLeavesNoFieldToTheCode) {
  std::set<std::string> given;
  add_given("configs/sgrt-2016.yaml", "", given);
  for (const sim::FieldInfo& field : sim::list_fields(tools::RunConfig())) {
    if (field.path.starts_with("scene.")) continue;  // belongs to the workload, not to the machine
    const bool is_map = field.kind == sim::FieldKind::kBandMap;
    const auto at = given.lower_bound(field.path);
    const bool found = at != given.end() && (*at == field.path || (is_map && at->starts_with(field.path + ".")));
    EXPECT_TRUE(found) << field.path << " is set in no file";
  }
}

TEST(Configs, AllMachinesLoad) {
  sim::set_config_search_path({repository() / "configs"});
  for (const fs::path& file : yaml_files()) {
    if (file.parent_path() == "configs") {
      EXPECT_NO_THROW(sim::load_config<tools::RunConfig>(repository() / file)) << file.string();
    }
  }
}

}  // namespace
}  // namespace test
