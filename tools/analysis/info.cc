#include "tools/analysis/info.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "sim/hash.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/run/frame/trace_header.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/node_format.h"
#include "traces/scene/info.h"
#include "traces/walk.h"

namespace tools {
namespace {

using sim::Json;
using traces::BvhConfig, traces::MemoryImage, traces::NodeFormat;
using traces::Hit, traces::Ray, traces::RayKind, traces::TreeBuilder;

std::vector<Ray> camera_rays(const traces::Camera& camera) {
  constexpr std::uint32_t kWidth = 128, kHeight = 64;
  const float up = std::tan(camera.vertical_fov / 2), right = up * kWidth / kHeight;
  std::vector<Ray> rays(std::size_t{kWidth} * kHeight);
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    const float x = (static_cast<float>(i % kWidth) + 0.5F) / kWidth * 2 - 1;
    const float y = 1 - (static_cast<float>(i / kWidth) + 0.5F) / kHeight * 2;
    rays[i].origin = glm::vec3(camera.to_world[3]);
    rays[i].direction = glm::normalize(glm::vec3(camera.to_world * glm::vec4(x * right, y * up, -1, 0)));
  }
  return rays;
}

/// Returns the normal of the triangle that was hit, on the side from which the ray came.
glm::vec3 normal_at(const MemoryImage& image, const Ray& ray, const Hit& hit) {
  const traces::TriangleRecord& t = image.triangles[hit.triangle_index()];
  glm::vec3 normal = glm::cross(t.v1 - t.v0, t.v2 - t.v0);
  if (image.has_two_levels()) {
    const auto& m = image.instances[traces::instance_index_of(hit)].to_object;
    normal = glm::vec3(m[0][0], m[0][1], m[0][2]) * normal.x + glm::vec3(m[1][0], m[1][1], m[1][2]) * normal.y +
             glm::vec3(m[2][0], m[2][1], m[2][2]) * normal.z;
  }
  normal = glm::normalize(normal);
  return glm::dot(normal, ray.direction) > 0 ? -normal : normal;
}

/// Returns a random point on the unit sphere, from points in a cube.
glm::vec3 point_on_sphere(std::uint64_t seed) {
  for (std::uint64_t i = 0;; i += 3) {
    glm::vec3 point;
    for (int a = 0; a < 3; ++a) {
      point[a] = 2 * sim::hash_to_unit_float(sim::hash(seed, i + static_cast<std::uint64_t>(a))) - 1;
    }
    const float length = glm::length(point);
    if (length <= 1 && length > 0.01F) return point / length;
  }
}

/// Returns a ray from each hit, with directions distributed by the cosine to the normal.
std::vector<Ray> diffuse_rays(const MemoryImage& image, const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
  std::vector<Ray> out;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i].is_hit()) continue;
    Ray& ray = out.emplace_back();
    ray.origin = rays[i].origin + hits[i].t * rays[i].direction;
    ray.direction = normal_at(image, rays[i], hits[i]) * 1.0001F + point_on_sphere(i);
    ray.t_min = 1e-4F * image.diagonal();
  }
  return out;
}

/// Traces rays and returns visits and triangle tests per ray.
Json steps_per_ray(const traces::BvhTracer& tracer, const std::vector<Ray>& rays, RayKind kind,
                   std::vector<Hit>& hits) {
  hits.assign(rays.size(), {});
  std::vector<std::uint32_t> words, begin;
  traces::WalkSink sink{words, begin};
  tracer.trace(rays, kind, hits, &sink);
  const auto steps = traces::count_steps(words);
  const auto count = static_cast<double>(std::max<std::size_t>(rays.size(), 1));
  return {{"visits", static_cast<double>(steps.visits) / count}, {"tests", static_cast<double>(steps.tests) / count}};
}

Json builder_row(const traces::Scene& scene, const MemoryImage& image, const BvhConfig& config) {
  const traces::BvhInfo info = traces::bvh_info(image, config);
  Json row = {{"builder", names_of(config.builder)[static_cast<std::size_t>(config.builder)]},
              {"nodes", info.nodes},
              {"leaves", info.leaves},
              {"depth", info.depth},
              {"sah_cost", info.sah_cost}};
  std::size_t rounds = 0;
  for (const traces::BuildStatistics& tree : image.build_statistics) {
    rounds = std::max(rounds, tree.ploc_clusters.size());
  }
  row["rounds"] = rounds;
  if (scene.cameras.empty()) return row;
  const traces::BvhTracer tracer(image);
  std::vector<Hit> hits, ignored;
  const std::vector<Ray> rays = camera_rays(scene.cameras.front());
  row["primary"] = steps_per_ray(tracer, rays, RayKind::kPrimary, hits);
  const std::vector<Ray> diffuse = diffuse_rays(image, rays, hits);
  row["diffuse"] = steps_per_ray(tracer, diffuse, RayKind::kReflection, ignored);
  row["shadow"] = steps_per_ray(tracer, diffuse, RayKind::kShadow, ignored);
  return row;
}

/// Returns a JSON array with a row per value of bvh.builder: size and SAH cost of the tree, rounds of ploc, and visits
/// and triangle tests per ray. Rays are 128 x 64 rays of the first camera, and a diffuse ray from each of their hits.
/// `image` is the scene's image with `config`.
Json tree_builders_json(const traces::Scene& scene, const MemoryImage& image, const BvhConfig& config) {
  Json rows = Json::array();
  for (const TreeBuilder builder : {TreeBuilder::kEmbree, TreeBuilder::kLbvh, TreeBuilder::kPloc}) {
    BvhConfig c = config;
    c.builder = builder;
    rows.push_back(builder_row(scene, builder == config.builder ? image : traces::build_memory_image(scene, c), c));
  }
  return rows;
}

/// Formats the result of tree_builders_json() as a table with a row per builder.
std::string tree_builders_text(const Json& builders) {
  std::string text =
      fmt::format("\n{:<10}{:>9} {:>9} {:>6} {:>7} {:>9} {:>16} {:>15} {:>14}\n", "builder", "nodes", "leaves", "depth",
                  "rounds", "SAH cost", "visits: primary", "diffuse ray", "shadow ray");
  const auto visits = [](const Json& row, const char* kind) {
    return row.contains(kind) ? fmt::format("{:.2f}", row[kind]["visits"].get<double>()) : std::string("-");
  };
  for (const Json& row : builders) {
    text += fmt::format("{:<10}{:>9} {:>9} {:>6} {:>7} {:>9.2f} {:>16} {:>15} {:>14}\n",
                        row["builder"].get<std::string>(), row["nodes"].get<std::uint64_t>(),
                        row["leaves"].get<std::uint64_t>(), row["depth"].get<std::uint64_t>(),
                        row["rounds"].get<std::uint64_t>(), row["sah_cost"].get<double>(), visits(row, "primary"),
                        visits(row, "diffuse"), visits(row, "shadow"));
  }
  return text;
}

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

/// Returns size, shape and SAH cost of a scene's tree for each width and node format, as a JSON array. Other keys are
/// those of `config`; a format that cannot store its leaves has smaller ones.
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

/// Formats the result of tree_formats_json() as a table with a row per format.
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

Json vector_json(const glm::vec4& v) { return {v.x, v.y, v.z}; }

Json cameras_json(const traces::Scene& scene) {
  Json list = Json::array();
  for (const traces::Camera& camera : scene.cameras) {
    list.push_back({{"name", camera.name},
                    {"position", vector_json(camera.to_world[3])},
                    {"direction", vector_json(-camera.to_world[2])},
                    {"vertical_fov_degrees", static_cast<double>(camera.vertical_fov) * 180 / std::numbers::pi}});
  }
  return list;
}

/// Returns, for each node format, the size in bytes of a BVH with this number of inner nodes and trees.
Json nodes_by_format(std::uint64_t inner_nodes, std::uint64_t trees) {
  using traces::BoxNumbers, traces::BoxRecords;
  Json formats = Json::object();
  if (inner_nodes == 0) return formats;  // a wide tree
  for (const BoxNumbers numbers : {BoxNumbers::kFp32, BoxNumbers::kHybrid}) {
    for (const BoxRecords boxes : {BoxRecords::kPair, BoxRecords::kSingle}) {
      const std::string_view of = names_of(numbers)[static_cast<std::size_t>(numbers)];
      const std::string_view in = names_of(boxes)[static_cast<std::size_t>(boxes)];
      formats[fmt::format("{} {}", of, in)] =
          traces::node_bytes(numbers, boxes) * traces::node_records(inner_nodes, boxes, trees);
    }
  }
  return formats;
}

/// Returns the size in bytes of each part (nodes, triangles, ...) of a scene's memory image; padding counts as
/// textures.
Json memory_json(const traces::MemoryImage& image) {
  const std::uint64_t labels =
      image.layout.has_labels() ? image.triangles.size() * traces::Layout::kLabelBytes : std::uint64_t{0};
  Json parts = {{"nodes", image.node_array_bytes()},
                {"triangles", image.layout.leaf_bytes + labels},
                {"attributes", image.attributes.size() * sizeof(traces::AttributeRecord)},
                {"vertices", image.vertices.size() * sizeof(traces::VertexRecord)},
                {"materials", image.materials.size() * sizeof(traces::MaterialRecord) +
                                  image.details.size() * sizeof(traces::MaterialDetailRecord)}};
  if (image.has_two_levels()) parts["instances"] = image.instances.size() * sizeof(traces::InstanceRecord);
  std::uint64_t sum = 0;
  for (const auto& [name, part] : parts.items()) sum += part.get<std::uint64_t>();
  parts["textures"] = image.layout.end - std::min(image.layout.end, sum);
  return {{"bytes", image.layout.end},
          {"parts", parts},
          {"nodes_by_format", nodes_by_format(image.nodes.size(), 1 + image.trees.size())}};
}

std::string count_text(std::uint64_t count, const char* what) {
  const std::string_view one = what;
  if (count != 1 && one == "leaf") return fmt::format("{} leaves", count);
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string bytes_text(const Json& bytes) { return sim::si_text(bytes.get<double>(), "B"); }

std::string sizes_text(const Json& sizes) {
  std::string text;
  for (const auto& [name, size] : sizes.items()) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, bytes_text(size));
  }
  return text;
}

std::string animation_text(const Json& animation) {
  if (animation["tracks"] == 0) return "none";
  return fmt::format("{:.3g} s, {}, {}, {}, {} move", animation["duration_s"].get<double>(),
                     count_text(animation["tracks"].get<std::uint64_t>(), "track"),
                     count_text(animation["skins"].get<std::uint64_t>(), "skin"),
                     count_text(animation["morph_targets"].get<std::uint64_t>(), "morph target"),
                     count_text(animation["moving_instances"].get<std::uint64_t>(), "instance"));
}

/// Formats the host time and memory that loading a scene took. Memory per triangle is shown only for scenes of at least
/// 10,000 triangles, because otherwise the program itself dominates.
std::string loading_cost_text(const Json& host, std::uint64_t triangles) {
  constexpr std::uint64_t kTrianglesThatTell = 10'000;
  std::string text = fmt::format("loaded in {:.2f} s, tree in {:.2f} s, peak memory {}", host["load_s"].get<double>(),
                                 host["build_s"].get<double>(), bytes_text(host["peak_bytes"]));
  if (triangles >= kTrianglesThatTell) {
    text += fmt::format(", {:.0f} bytes per triangle beyond the file", host["bytes_per_triangle"].get<double>());
  }
  return text;
}

std::string camera_text(const Json& camera) {
  const auto triple = [](const Json& v) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
  };
  return fmt::format("at {}, direction {}, vertical field of view {:.1f} degrees", triple(camera["position"]),
                     triple(camera["direction"]), camera["vertical_fov_degrees"].get<double>());
}

}  // namespace

Json scene_info_json(const traces::Scene& scene, const traces::MemoryImage& image, const BvhConfig& config,
                     const SceneCost& cost) {
  const traces::SceneInfo info = traces::scene_info(scene);
  const traces::BvhInfo tree = traces::bvh_info(image);
  const auto triangles = static_cast<double>(std::max<std::size_t>(info.triangles, 1));
  const std::uint64_t beyond = cost.peak_bytes - std::min(cost.peak_bytes, cost.file_bytes);
  return {{"schema", "raywatt-scene/1"},
          {"name", info.name},
          {"sha256", scene.sha256},
          {"triangles", info.triangles},
          {"stored_triangles", info.stored_triangles},
          {"instances", info.instances},
          {"meshes", info.meshes},
          {"materials", info.materials},
          {"textures", {{"count", info.textures}, {"bytes", info.texture_bytes}}},
          {"lights", info.lights},
          {"cameras", cameras_json(scene)},
          {"animation",
           {{"duration_s", info.duration},
            {"tracks", info.tracks},
            {"skins", info.skins},
            {"morph_targets", info.morph_targets},
            {"moving_instances", info.moving_instances}}},
          {"memory_image", memory_json(image)},
          {"bvh",
           {{"nodes", tree.nodes},
            {"leaves", tree.leaves},
            {"depth", tree.depth},
            {"sah_cost", tree.sah_cost},
            {"mean_children", tree.mean_children()},
            {"occupancy", tree.occupancy()},
            {"triangles_per_leaf", tree.triangles_per_leaf()},
            {"bytes_per_triangle", tree.bytes_per_triangle()}}},
          {"trees", tree_formats_json(scene, config)},
          {"builders", tree_builders_json(scene, image, config)},
          {"warnings", scene.warnings},
          {"host",
           {{"load_s", cost.load_s},
            {"build_s", cost.build_s},
            {"file_bytes", cost.file_bytes},
            {"peak_bytes", cost.peak_bytes},
            {"bytes_per_triangle", static_cast<double>(beyond) / triangles}}}};
}

std::string scene_info_text(const Json& info, bool cameras) {
  std::string text;
  const auto line = [&](std::string_view what, const std::string& value) {
    text += fmt::format("{:<18}{}\n", what, value);
  };
  const auto triangles = info["triangles"].get<std::uint64_t>(), stored = info["stored_triangles"].get<std::uint64_t>();
  line("scene", info["name"].get<std::string>());
  line("triangles", triangles == stored ? std::to_string(triangles) : fmt::format("{} ({} stored)", triangles, stored));
  const auto meshes = info["meshes"].get<std::uint64_t>();
  line("instances",
       fmt::format("{} of {} {}", info["instances"].get<std::uint64_t>(), meshes, meshes == 1 ? "mesh" : "meshes"));
  line("materials", std::to_string(info["materials"].get<std::uint64_t>()));
  const Json& textures = info["textures"];
  line("textures", textures["count"] == 0 ? "0"
                                          : fmt::format("{}, {:.1f} MiB", textures["count"].get<std::uint64_t>(),
                                                        textures["bytes"].get<double>() / (1 << 20)));
  line("lights", std::to_string(info["lights"].get<std::uint64_t>()));
  std::string names;
  for (const Json& camera : info["cameras"]) {
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", camera["name"].get<std::string>());
  }
  line("cameras", names);
  for (const Json& camera : info["cameras"]) {
    if (cameras) line("", fmt::format("'{}' {}", camera["name"].get<std::string>(), camera_text(camera)));
  }
  line("animation", animation_text(info["animation"]));
  const Json& memory = info["memory_image"];
  line("memory image", fmt::format("{} ({})", bytes_text(memory["bytes"]), sizes_text(memory["parts"])));
  if (!memory["nodes_by_format"].empty()) line("nodes by format", sizes_text(memory["nodes_by_format"]));
  const Json& tree = info["bvh"];
  line("BVH", fmt::format("{}, {}, depth {}, SAH cost {:.1f}", count_text(tree["nodes"].get<std::uint64_t>(), "node"),
                          count_text(tree["leaves"].get<std::uint64_t>(), "leaf"), tree["depth"].get<std::uint64_t>(),
                          tree["sah_cost"].get<double>()));
  line("",
       fmt::format("{:.2f} children per node ({:.0f} % of slots), {:.2f} triangles per leaf, {:.1f} bytes per triangle",
                   tree["mean_children"].get<double>(), 100 * tree["occupancy"].get<double>(),
                   tree["triangles_per_leaf"].get<double>(), tree["bytes_per_triangle"].get<double>()));
  line("host", loading_cost_text(info["host"], triangles));
  return text + tree_formats_text(info["trees"]) + tree_builders_text(info["builders"]);
}

namespace {

std::string text_at(const Json& json, const char* key) { return sim::printable(json.at(key).get<std::string>()); }

}  // namespace

Json trace_info(const traces::TraceReader& trace) {
  return trace.add_file_name_to_errors([&] {
    const Json& header = trace.header();
    check_header(header);
    constexpr std::uint64_t kMost = std::uint64_t{1} << 48;
    std::uint64_t tiles = 0, rays = 0, steps = 0, bytes = 0;
    for (const traces::TraceReader::Part& part : trace.parts()) {
      tiles += part.tiles;
      for (const Json& kind : part.result.at("rays")) rays += traces::number_of(kind, kMost, "rays");
      steps += traces::number_at(part.result, "traversal_steps", kMost);
      for (const traces::TraceReader::FileRange& tile : trace.tiles(part)) bytes += tile.bytes;
    }
    const Json& scene = header.at("scene");
    const auto side = [&](std::size_t i) {
      return traces::number_of(header.at("resolution").at(i), 1U << 16, "resolution");
    };
    Json info = {{"schema", "raywatt-trace-info/1"},
                 {"version", trace.file_version()},
                 {"program", text_at(header, "program")},
                 {"reference", text_at(header, "reference")},
                 {"resolution", {side(0), side(1)}},
                 {"scene",
                  {{"name", text_at(scene, "name")},
                   {"triangles", traces::number_at(scene, "triangles", kMost)},
                   {"sha256", text_at(scene, "sha256")},
                   {"bvh_hash", text_at(scene, "bvh_hash")}}},
                 {"frames", trace.frames().size()},
                 {"trees", trace.tree_count()},
                 {"tiles", tiles},
                 {"rays", rays},
                 {"traversal_steps", steps},
                 {"bytes", trace.file_bytes()},
                 {"tile_bytes", bytes}};
    const double per_ray = rays == 0 ? 0 : static_cast<double>(trace.file_bytes()) / static_cast<double>(rays);
    info["bytes_per_ray"] = per_ray;
    info["function"] = Json::object();
    for (const auto& [key, value] : header.at("function").items()) {
      info["function"][sim::printable(key)] = sim::printable(value.get<std::string>());
    }
    return info;
  });
}

std::string trace_info_text(const Json& info) {
  const auto count = [&](const char* key) { return sim::si_text(info[key].get<double>()); };
  std::string program = info["program"].get<std::string>();
  if (info["reference"] != "") program += ", compared with " + info["reference"].get<std::string>();
  const Json& scene = info["scene"];
  std::string out;
  const auto line = [&](const char* name, const std::string& value) {
    out += fmt::format("  {:<22}{}\n", name, value);
  };
  line("format", fmt::format("raywatt-trace/{}", info["version"].get<int>()));
  line("program", program);
  line("resolution", fmt::format("{}x{}", info["resolution"].at(0).get<int>(), info["resolution"].at(1).get<int>()));
  line("scene", fmt::format("{} ({} triangles)", scene["name"].get<std::string>(),
                            sim::si_text(scene["triangles"].get<double>())));
  line("frames", std::to_string(info["frames"].get<std::size_t>()));
  line("tiles", count("tiles"));
  line("rays", count("rays"));
  line("traversal steps", count("traversal_steps"));
  line("bytes", fmt::format("{}B = {:.1f} per ray", count("bytes"), info["bytes_per_ray"].get<double>()));
  line("keys of the work", fmt::format("{}; raywatt trace info --json lists them", info["function"].size()));
  return out;
}

}  // namespace tools
