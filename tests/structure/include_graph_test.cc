#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/structure/repository.h"
#include "tests/structure/sources.h"

// Tests that includes between folders have no cycle, and that docs/includes.md draws them. After a change of the graph
// run:
//   RAYWATT_UPDATE=1 build/release/tests/test_structure --gtest_filter='IncludeGraph.*'

namespace test {
namespace {

namespace fs = std::filesystem;

/// For each folder, the folders that its files include.
using Graph = std::map<std::string, std::set<std::string>>;

/// Folders that are drawn as one node together with their subfolders.
constexpr std::array kWhole = {"shader_kernels/kernels", "traces/accel/", "traces/scene/", "traces/scenes/",
                               "tools/studies/optimise/"};

std::string folder_of(const fs::path& file) {
  const std::string folder = file.parent_path().generic_string();
  if (folder == kWhole[0]) return "shader_kernels";
  for (const std::string whole : kWhole) {
    if (folder.starts_with(whole)) return whole.substr(0, whole.size() - 1);
  }
  return folder;
}

Graph include_graph() {
  Graph graph;
  for (const fs::path& file : source_files()) {
    if (!file.generic_string().starts_with("tests/")) graph[folder_of(file)];
  }
  for (const Include& include : includes()) {
    const std::string from = folder_of(include.from), to = folder_of(include.to);
    if (graph.contains(from) && graph.contains(to) && from != to) graph[from].insert(to);
  }
  return graph;
}

/// Returns the folders from the bottom up. Folders in or above a cycle are missing.
std::vector<std::string> bottom_up(const Graph& graph) {
  std::vector<std::string> order;
  const auto placed = [&](const std::string& folder) { return std::ranges::count(order, folder) != 0; };
  for (std::size_t before = 1; before != 0;) {
    before = 0;
    for (const auto& [folder, below] : graph) {
      if (placed(folder) || !std::ranges::all_of(below, placed)) continue;
      order.push_back(folder);
      ++before;
    }
  }
  return order;
}

/// Returns the folders that a folder includes and does not reach through another one: its arrows in the drawing.
std::set<std::string> arrows(const Graph& graph, const std::string& folder) {
  std::set<std::string> indirect;
  const std::function<void(const std::string&)> add = [&](const std::string& at) {
    for (const std::string& below : graph.at(at)) {
      if (indirect.insert(below).second) add(below);
    }
  };
  for (const std::string& below : graph.at(folder)) add(below);
  std::set<std::string> direct;
  std::ranges::set_difference(graph.at(folder), indirect, std::inserter(direct, direct.end()));
  return direct;
}

std::string page_of(const Graph& graph) {
  std::ostringstream page;
  page << "# Which folder includes which\n\n"
          "`tests/structure/include_graph_test.cc` writes this page from the sources, with RAYWATT_UPDATE=1. No arrow "
          "points\n"
          "up, and there is no cycle. Arrows implied by others are left out.\n\n"
          "Parts of one subject are drawn as one folder: `shader_kernels` with its kernels; `traces/accel`, "
          "`traces/scene`,\n"
          "`traces/scenes` and `tools/studies/optimise` with the folders below.\n"
          "\n```mermaid\ngraph TD\n";
  std::vector<std::string> order = bottom_up(graph);
  std::ranges::reverse(order);
  for (const std::string& folder : order) {
    for (const std::string& below : arrows(graph, folder)) page << "  " << folder << " --> " << below << '\n';
  }
  page << "```\n";
  return page.str();
}

TEST(IncludeGraph, HasNoCircle) {
  const Graph graph = include_graph();
  EXPECT_GT(graph.size(), 20U) << "the scan sees the folders";
  const std::vector<std::string> order = bottom_up(graph);
  for (const auto& [folder, below] : graph) {
    EXPECT_NE(std::ranges::count(order, folder), 0) << folder << " is in a circle, or above one";
  }
}

TEST(IncludeGraph, IsDrawnInTheDocumentation) {
  const fs::path file = repository() / "docs/includes.md";
  const std::string page = page_of(include_graph());
  if (std::getenv("RAYWATT_UPDATE") != nullptr) std::ofstream(file) << page;
  std::ostringstream drawn;
  drawn << std::ifstream(file).rdbuf();
  EXPECT_EQ(drawn.str(), page) << "RAYWATT_UPDATE=1 in the environment of this test writes the page again";
}

}  // namespace
}  // namespace test
