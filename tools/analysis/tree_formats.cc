#include "tools/analysis/tree_formats.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"

namespace tools {
namespace {

using sim::Json;
using traces::BvhConfig, traces::MemoryImage, traces::NodeFormat;

struct Form {
  std::uint32_t width;
  NodeFormat format;
};

constexpr Form kForms[] = {{2, NodeFormat::kFp32},   {2, NodeFormat::kHybrid}, {4, NodeFormat::kFp32},
                           {4, NodeFormat::kHybrid}, {4, NodeFormat::kQ8},     {6, NodeFormat::kFp32},
                           {6, NodeFormat::kQ8},     {8, NodeFormat::kFp32},   {8, NodeFormat::kHybrid},
                           {8, NodeFormat::kQ8},     {8, NodeFormat::kQ12},    {8, NodeFormat::kCw80}};

/// Builds trees of one scene in several formats. Formats with equal leaves share a binary tree if there is one level.
class FormatBuilder {
 public:
  explicit FormatBuilder(const traces::Scene& scene) : scene_(scene) {}

  MemoryImage build(const BvhConfig& config) {
    if (config.instances == traces::InstanceLevels::kTwoLevel) return traces::build_memory_image(scene_, config);
    if (!binary_ || leaf_size_ != config.leaf_size) {
      BvhConfig plain = config;
      plain.width = 2;
      plain.format = NodeFormat::kFp32;
      plain.leaf = traces::LeafFormat::kTriangles;
      binary_ = traces::build_memory_image(scene_, plain);
      leaf_size_ = config.leaf_size;
    }
    return traces::reformat_tree(*binary_, config);
  }

 private:
  const traces::Scene& scene_;
  std::optional<MemoryImage> binary_;
  std::uint32_t leaf_size_ = 0;
};

}  // namespace

Json tree_formats_json(const traces::Scene& scene, const BvhConfig& config) {
  Json rows = Json::array();
  FormatBuilder builder(scene);
  for (const Form& form : kForms) {
    BvhConfig c = config;
    c.numbers = traces::BoxNumbers::kFp32;
    c.boxes = traces::BoxRecords::kPair;
    c.width = form.width;
    c.format = form.format;
    if (form.format == NodeFormat::kHybrid && c.instances == traces::InstanceLevels::kTwoLevel) continue;
    if (traces::is_quantised(form.format)) c.triangle_bytes = 48;
    c.leaf_size = std::min(c.leaf_size, c.most_leaf_triangles());
    const traces::BvhInfo info = traces::bvh_info(builder.build(c));
    rows.push_back({{"width", form.width},
                    {"format", names_of(form.format)[static_cast<std::size_t>(form.format)]},
                    {"nodes", info.nodes},
                    {"mean_children", info.mean_children()},
                    {"occupancy", info.occupancy()},
                    {"leaves", info.leaves},
                    {"triangles_per_leaf", info.triangles_per_leaf()},
                    {"depth", info.depth},
                    {"bytes_per_triangle", info.bytes_per_triangle()},
                    {"sah_cost", info.sah_cost}});
  }
  return rows;
}

std::string tree_formats_text(const Json& formats) {
  std::string text = fmt::format("\n{:<18}{:>9} {:>9} {:>9} {:>11} {:>6} {:>15} {:>9}\n", "tree", "nodes", "children",
                                 "occupancy", "tri. a leaf", "depth", "bytes a triangle", "SAH cost");
  for (const Json& row : formats) {
    text += fmt::format("{:<18}{:>9} {:>9.2f} {:>8.0f}% {:>11.2f} {:>6} {:>16.1f} {:>9.2f}\n",
                        fmt::format("{} {}", row["width"].get<int>(), row["format"].get<std::string>()),
                        row["nodes"].get<std::uint64_t>(), row["mean_children"].get<double>(),
                        100 * row["occupancy"].get<double>(), row["triangles_per_leaf"].get<double>(),
                        row["depth"].get<std::uint64_t>(), row["bytes_per_triangle"].get<double>(),
                        row["sah_cost"].get<double>());
  }
  return text;
}

}  // namespace tools
