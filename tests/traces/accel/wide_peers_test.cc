#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <zstd.h>

#include "tests/full_size.h"
#include "tests/real_scenes.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/scenes/library.h"
#include "wide_walks.h"

// Trees and walks against figures that another program made of the same binary trees, triangles and rays. The files are
// next to the large scenes; their README describes each figure.

namespace traces {
namespace {

std::filesystem::path peers_folder() { return ::test::scenes_folder().parent_path() / "reference" / "today" / "peers"; }

using Row = std::map<std::string, std::string>;

std::vector<Row> read_table(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line, cell;
  std::vector<std::string> names;
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    Row row;
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      rows.empty() && names.size() == i ? names.push_back(cell) : void(row[names[i]] = cell);
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

double figure(const Row& row, const char* column) { return std::strtod(row.at(column).c_str(), nullptr); }

std::vector<Ray> read_rays(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string packed{std::istreambuf_iterator<char>(in), {}};
  std::vector<Ray> rays(ZSTD_getFrameContentSize(packed.data(), packed.size()) / sizeof(Ray));
  static_assert(sizeof(Ray) == 32);
  const std::size_t size = ZSTD_decompress(rays.data(), rays.size() * sizeof(Ray), packed.data(), packed.size());
  EXPECT_EQ(size, rays.size() * sizeof(Ray));
  return rays;
}

/// The widths of the peers' trees, by name.
const std::map<std::string, std::uint32_t> kTrees = {
    {"embree-medium/bvh2", 2}, {"embree-medium/bvh4", 4}, {"embree-medium/bvh6", 6}, {"embree-medium/bvh8", 8}};

class WidePeers : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(peers_folder())) GTEST_SKIP() << "there are no figures in " << peers_folder();
    const std::string name = GetParam();
    if ((name == "hairball-2880k" || name == "garden-outdoor-643k") && !::test::is_full_size())
      GTEST_SKIP() << "tools/validate full";
    const std::filesystem::path file = ::test::scenes_folder() / (name + ".glb");
    if (name != "cornell" && !std::filesystem::exists(file)) GTEST_SKIP() << "there is no " << file;
    scene_ = open_scene(name == "cornell" ? name : file.string());
    // The other program hits both faces of every triangle, and ends an any-hit ray at any triangle.
    for (Material& material : scene_.materials) {
      material.double_sided = true;
      material.alpha = Material::Alpha::kOpaque;
      material.transmission = 0;
    }
  }
  MemoryImage image_of(std::uint32_t width) const { return build_memory_image(scene_, {.width = width}); }

  Scene scene_;
};

TEST_P(WidePeers, CollapseToTheSameTrees) {
  int compared = 0;
  for (const Row& row : read_table(peers_folder() / "trees.csv")) {
    const auto tree = kTrees.find(row.at("tree"));
    if (row.at("scene") != GetParam() || tree == kTrees.end()) continue;
    SCOPED_TRACE(row.at("tree"));
    const BvhInfo info = bvh_info(image_of(tree->second));
    // Collapse keeps leaves. Of hairball's 1.5 million, the binary tree already has two more than the other program's.
    EXPECT_NEAR(static_cast<double>(info.leaves), figure(row, "leaves"), row.at("scene") == "hairball-2880k" ? 2 : 0);
    EXPECT_NEAR(static_cast<double>(info.nodes) / figure(row, "inner_nodes"), 1, 0.002);
    EXPECT_NEAR(info.sah_cost / figure(row, "sah_cost"), 1, 0.002);
    EXPECT_NEAR(info.depth, figure(row, "depth"), 1);
    EXPECT_NEAR(info.mean_children(), figure(row, "mean_children"), 0.01);
    ++compared;
  }
  EXPECT_EQ(compared, 4);
}

TEST_P(WidePeers, VisitTheSameNodes) {
  std::map<std::string, std::vector<Ray>> rays;
  for (const char* kind : {"primary", "ao", "diffuse"}) {
    rays[kind] = read_rays(peers_folder() / "rays" / (std::string(GetParam()) + "-" + kind + ".rays.zst"));
  }
  std::map<std::uint32_t, MemoryImage> images;
  std::map<std::string, double> largest;  // deviation in percent, by kind of ray and column
  int compared = 0;
  for (const Row& row : read_table(peers_folder() / "traversal.csv")) {
    const auto tree = kTrees.find(row.at("tree"));
    if (row.at("scene") != GetParam() || tree == kTrees.end()) continue;
    SCOPED_TRACE(row.at("tree") + " " + row.at("rays") + " " + row.at("query"));
    if (!images.contains(tree->second)) images[tree->second] = image_of(tree->second);
    const MemoryImage& image = images.at(tree->second);
    const bool any = row.at("query") == "any";
    std::vector<Hit> hits;
    const WalkCounts c = count_walks(image, rays.at(row.at("rays")), any ? RayKind::kShadow : RayKind::kPrimary, hits);
    const auto expect_near = [&](std::uint64_t counted, const char* column, double tolerance) {
      const double mean = static_cast<double>(counted) / static_cast<double>(c.rays);
      EXPECT_NEAR(mean / figure(row, column), 1, tolerance) << column;
      double& deviation = largest[row.at("query") + "_" + column];
      deviation = std::max(deviation, 100 * std::abs(mean / figure(row, column) - 1));
    };
    EXPECT_EQ(c.rays, static_cast<std::uint64_t>(figure(row, "count")));
    expect_near(c.visits, "node_visits", any ? 0.03 : 0.005);
    expect_near(c.boxes, "box_tests", any ? 0.03 : 0.005);
    expect_near(c.pushes, "pushes", any ? 0.07 : 0.01);
    expect_near(c.triangles, "triangle_tests", any ? 0.07 : 0.02);
    EXPECT_NEAR(static_cast<double>(c.deepest), figure(row, "max_stack"), 3);
    EXPECT_EQ(c.hit_children, (c.visits - c.roots) + c.leaves + c.culled + c.dropped);
    EXPECT_EQ(c.pushes, c.pops + c.culled + c.dropped);
    ++compared;
  }
  for (const auto& [name, percent] : largest) RecordProperty(name, std::to_string(percent));
  EXPECT_EQ(compared, 16);
}

TEST_P(WidePeers, HitTheSameInAllFormatsWithFewMoreVisits) {
  constexpr std::uint32_t kLeaf = 3;  // as many as all formats can store
  const MemoryImage binary = build_memory_image(scene_, {.leaf_size = kLeaf});
  std::map<std::string, std::vector<Ray>> rays;
  std::map<std::string, std::vector<Hit>> nearest, blocked;
  std::map<std::string, std::uint64_t> exact_visits;
  for (const char* kind : {"primary", "ao", "diffuse"}) {
    rays[kind] = read_rays(peers_folder() / "rays" / (std::string(GetParam()) + "-" + kind + ".rays.zst"));
    count_walks(binary, rays[kind], RayKind::kPrimary, nearest[kind]);
    count_walks(binary, rays[kind], RayKind::kShadow, blocked[kind]);
  }
  for (const auto& [width, format] : {std::pair{4U, NodeFormat::kFp32},
                                      {6U, NodeFormat::kFp32},
                                      {8U, NodeFormat::kFp32},
                                      {8U, NodeFormat::kHybrid},
                                      {8U, NodeFormat::kQ8},
                                      {8U, NodeFormat::kQ12},
                                      {8U, NodeFormat::kCw80}}) {
    const MemoryImage image = reformat_tree(binary, {.leaf_size = kLeaf, .width = width, .format = format});
    const std::string name(names_of(format)[static_cast<std::size_t>(format)]);
    for (const auto& [kind, list] : rays) {
      SCOPED_TRACE(name + " " + std::to_string(width) + " " + kind);
      std::vector<Hit> hits;
      const std::uint64_t visits = count_walks(image, list, RayKind::kPrimary, hits).visits;
      std::size_t different = 0;
      for (std::size_t i = 0; i < list.size(); ++i) {
        different += name_hit(image, hits[i]) == name_hit(binary, nearest[kind][i]) ? 0 : 1;
      }
      EXPECT_EQ(different, 0U) << "nearest hits";
      count_walks(image, list, RayKind::kShadow, hits);
      for (std::size_t i = 0; i < list.size(); ++i) different += hits[i].is_hit() == blocked[kind][i].is_hit() ? 0 : 1;
      EXPECT_EQ(different, 0U) << "any hits";
      if (width == 8 && format == NodeFormat::kFp32) exact_visits[kind] = visits;
      if (format == NodeFormat::kFp32) continue;
      const double ratio = static_cast<double>(visits) / static_cast<double>(exact_visits[kind]);
      RecordProperty(name + "_" + kind, std::to_string(ratio));
      // q12 stores upper planes less one, so a flat box at the end of the grid is a step thick. Cornell's walls are
      // such boxes, and contain the rays that begin on them.
      const bool has_thick_walls = format == NodeFormat::kQ12 && std::string(GetParam()) == "cornell";
      EXPECT_LT(ratio, has_thick_walls ? 1.21 : 1.12);
      EXPECT_GT(ratio, 0.999);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, WidePeers,
                         testing::Values("cornell", "teapot-16k", "chess-42k", "conference-331k", "garden-outdoor-643k",
                                         "hairball-2880k"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace traces
