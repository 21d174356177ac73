#include "tools/analysis/tree_builders.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "sim/hash.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/walk.h"

namespace tools {
namespace {

using sim::Json;
using traces::MemoryImage, traces::Ray, traces::Hit, traces::RayKind, traces::TreeBuilder;

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

Json builder_row(const traces::Scene& scene, const MemoryImage& image, const traces::BvhConfig& config) {
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

}  // namespace

Json tree_builders_json(const traces::Scene& scene, const MemoryImage& image, const traces::BvhConfig& config) {
  Json rows = Json::array();
  for (const TreeBuilder builder : {TreeBuilder::kEmbree, TreeBuilder::kLbvh, TreeBuilder::kPloc}) {
    traces::BvhConfig c = config;
    c.builder = builder;
    rows.push_back(builder_row(scene, builder == config.builder ? image : traces::build_memory_image(scene, c), c));
  }
  return rows;
}

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

}  // namespace tools
