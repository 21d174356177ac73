#include "traces/accel/build/two_level.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <set>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "tests/traces/accel/support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"

namespace traces {
namespace {

constexpr BvhConfig kLevels{.instances = InstanceLevels::kTwoLevel};

/// Returns rays towards the scene from the largest distance for which instance boxes are padded.
std::vector<Ray> far_rays(const MemoryImage& image, std::uint32_t count) {
  Dice dice(12);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = dice.direction() * 8.0F * image.diagonal();
    ray.direction = dice.point() - ray.origin;
  }
  return rays;
}

TEST(HitOfInstances, HoldsTheInstanceAndTheWeightsInFourWords) {
  Dice dice(1);
  for (int i = 0; i < 10000; ++i) {
    const float u = dice.unit();
    const Hit hit{1, u, dice.unit() * (1 - u), 77};
    const std::uint32_t instance = dice.below(kMaxInstances);
    const Hit packed = with_instance(hit, instance);
    EXPECT_EQ(instance_index_of(packed), instance);
    const auto weight = [](float word) {
      return static_cast<double>(std::bit_cast<std::uint32_t>(word) >> kHalfBits) / kWeightOne;
    };
    EXPECT_NEAR(weight(packed.u), hit.u, 2.0 / kWeightOne);
    EXPECT_NEAR(weight(packed.v), hit.v, 2.0 / kWeightOne);
    EXPECT_LE(weight(packed.u) + weight(packed.v), 1);
  }
  const Hit corner = with_instance({0, 1, 0, 0}, kMaxInstances - 1);
  EXPECT_EQ(instance_index_of(corner), kMaxInstances - 1);
}

TEST(TwoLevels, GiveTheSameHitsWithAnyTree) {
  for (const std::uint32_t leaf_size : {1U, 4U}) {
    BvhConfig config = kLevels;
    config.leaf_size = leaf_size;
    for (const Scene& scene : {scattered(80), scattered(1), with_transparent_triangles(grid_soup(500))}) {
      const MemoryImage image = build_memory_image(scene, config);
      for (const std::vector<Ray>& rays : {random_rays(600), grid_rays(600), far_rays(image, 200)}) {
        std::vector<Hit> expected;
        for (const Ray& ray : rays) expected.push_back(test_all(image, ray));
        EXPECT_EQ(count_different(trace(BvhTracer(image), rays), expected), 0U);
      }
    }
  }
}

TEST(TwoLevels, RaysAimedAtEdgesAreNotLostByTheBoxesAroundInstances) {
  const MemoryImage image = build_memory_image(scattered(80), kLevels);
  Dice dice(31);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < image.instances.size(); ++i) {
    if (image.tree_of[i] == kNone) continue;
    const ObjectTree& tree = image.trees[image.tree_of[i]];
    const auto& m = image.instances[i].to_object;
    const glm::mat4 to_object(m[0][0], m[1][0], m[2][0], 0, m[0][1], m[1][1], m[2][1], 0, m[0][2], m[1][2], m[2][2], 0,
                              m[0][3], m[1][3], m[2][3], 1);
    const glm::mat4 to_world = glm::inverse(to_object);
    for (int k = 0; k < 40; ++k) {
      const TriangleRecord& t = image.triangles[tree.first_triangle + dice.below(tree.triangles)];
      const float along = dice.unit();
      const glm::vec3 at(to_world * glm::vec4(t.v1 * along + t.v2 * (1 - along), 1));
      const glm::vec3 from = dice.point(-3, 3);
      rays.push_back({.origin = from, .direction = at - from});
    }
  }
  std::vector<Hit> expected;
  for (const Ray& ray : rays) expected.push_back(test_all(image, ray));
  EXPECT_EQ(count_different(trace(BvhTracer(image), rays), expected), 0U);
}

TEST(TwoLevels, PortableArithmeticGivesTheSameBits) {
  for (const Scene& scene : {scattered(100), with_transparent_triangles(triangle_soup(2000, 0.1F))}) {
    EXPECT_EQ(count_different_in_portable(build_memory_image(scene, kLevels), random_rays(20000)), 0U);
  }
}

TEST(TwoLevels, FindTheHitsOfTheFlattenedScene) {
  const Scene scene = scattered(100);
  const MemoryImage flat = build_memory_image(scene);
  const MemoryImage levels = build_memory_image(scene, kLevels);
  EXPECT_EQ(levels.lower, flat.lower);
  EXPECT_EQ(levels.upper, flat.upper);
  const std::vector<Ray> rays = random_rays(50000);
  const std::vector<Hit> a = trace(BvhTracer(flat), rays), b = trace(BvhTracer(levels), rays);
  int hits = 0, different = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (a[i].is_hit() != b[i].is_hit()) {
      ++different;
    } else if (a[i].is_hit()) {
      ++hits;
      different += flat.triangles[a[i].triangle_index()].object != instance_index_of(b[i]) ? 1 : 0;
      const float bound = 1e-4F * a[i].t + 1e-5F * flat.diagonal() / glm::length(rays[i].direction);
      different += std::abs(a[i].t - b[i].t) > bound ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 8000);
  EXPECT_LE(different, 5) << "only where rounding decides";
}

TEST(TwoLevels, AgreeWithEmbreesInstances) {
  for (const Scene& scene : {scattered(100), with_transparent_triangles(triangle_soup(2000, 0.1F))}) {
    const MemoryImage image = build_memory_image(scene, kLevels);
    const BvhTracer bvh(image);
    const EmbreeTracer embree(image, 1);
    const VerifyingTracer verifying(image, bvh, embree);
    for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) trace(verifying, random_rays(50000), kind);
    EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
    EXPECT_EQ(verifying.verify_counts().reference_errors, 0U);
    EXPECT_LE(verifying.verify_counts().edge_ties, 20U);
  }
}

TEST(TwoLevels, AWrongInstanceIsADistanceError) {
  struct Swapping : Tracer {
    explicit Swapping(const MemoryImage& image) : bvh(image) {}
    void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override {
      bvh.trace(rays, kind, hits, walk);
      for (Hit& hit : hits) {
        if (!hit.is_hit()) continue;
        const std::uint32_t other = (instance_index_of(hit) + 4) % 80;  // another instance of the same mesh
        hit.u = std::bit_cast<float>((std::bit_cast<std::uint32_t>(hit.u) & ~kHalfMask) | other);
      }
    }
    BvhTracer bvh;
  };
  const MemoryImage image = build_memory_image(scattered(80), kLevels);
  const Swapping wrong(image);
  const EmbreeTracer embree(image, 1);
  const VerifyingTracer verifying(image, wrong, embree);
  trace(verifying, random_rays(2000));
  EXPECT_GT(verifying.verify_counts().distance_errors, 100U);
}

TEST(TwoLevels, AMeshIsStoredOnceForAllItsInstances) {
  Scene scene = sphere(20, 40);
  const std::size_t triangles = scene.meshes[0].triangles.size();
  scene.instances.resize(500, scene.instances[0]);
  for (std::size_t i = 0; i < 500; ++i) scene.instances[i].to_world[3].x = 3 * static_cast<float>(i);
  const MemoryImage image = build_memory_image(scene, kLevels);
  EXPECT_EQ(image.triangles.size(), triangles);
  EXPECT_EQ(image.attributes.size(), triangles);
  EXPECT_EQ(image.instances.size(), 500U);
  EXPECT_EQ(image.trees.size(), 1U);
  EXPECT_EQ(image.layout.instances % 64, 0U);
  EXPECT_GE(image.layout.triangles, image.layout.instance_at(500));
  EXPECT_LT(image.layout.end, 30 * build_memory_image(one_triangle()).layout.end + 500 * 128 + triangles * 200);
}

TEST(TwoLevels, MeshesThatDeformOrCannotBeInvertedHaveTheirOwnTree) {
  Scene scene = sphere(6, 8);
  scene.instances.resize(4, scene.instances[0]);
  scene.instances[1].to_world[1] = glm::vec4(0);
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes[1].deformation = std::make_shared<Deformation>();
  scene.instances[3].mesh = 1;
  const MemoryImage image = build_memory_image(scene, kLevels);
  ASSERT_EQ(image.trees.size(), 3U);
  EXPECT_EQ(image.tree_of, (std::vector<std::uint32_t>{0, 1, 0, 2}));
  EXPECT_EQ(image.trees[1].only, 1U);
  EXPECT_TRUE(image.trees[1].in_world);
  EXPECT_EQ(image.trees[2].only, 3U);
  EXPECT_FALSE(image.trees[2].in_world);
}

TEST(FlatInstances, HaveFiniteRecordsInTreesOfOneAndTwoLevels) {
  // Matrices without inverse: to a plane, a line, a point, and to a plane with a determinant that is not 0 because of
  // rounding.
  const glm::mat4 turn = glm::rotate(glm::mat4(1), 0.7F, glm::vec3(1, 2, 3));
  const glm::mat4 flat[] = {glm::scale(glm::mat4(1), {1, 1, 0}), glm::scale(glm::mat4(1), {0, 2, 0}),
                            glm::scale(glm::mat4(1), {0, 0, 0}),
                            turn * glm::scale(glm::mat4(1), {1, 1, 0}) * turn * glm::scale(glm::mat4(1), {2, 0.5F, 1})};
  const auto is_finite = [](const glm::vec3& v) { return std::isfinite(v.x + v.y + v.z); };
  for (const glm::mat4& to_world : flat) {
    Scene scene = sphere(6, 8);
    scene.instances.resize(2, scene.instances[0]);
    scene.instances[1].to_world = to_world;
    for (const InstanceLevels levels : {InstanceLevels::kFlatten, InstanceLevels::kTwoLevel}) {
      const MemoryImage image = build_memory_image(scene, {.instances = levels});
      for (const AttributeRecord& record : image.attributes) {
        for (const glm::vec3& normal : record.normal) {
          EXPECT_TRUE(is_finite(normal));
          EXPECT_NEAR(glm::length(normal), 1, 1e-5);
        }
      }
      for (const TriangleRecord& t : image.triangles)
        EXPECT_TRUE(is_finite(t.v0) && is_finite(t.v1) && is_finite(t.v2));
      for (const InstanceRecord& instance : image.instances) {
        for (const auto& row : instance.to_object) EXPECT_TRUE(std::isfinite(row[0] + row[1] + row[2] + row[3]));
      }
    }
  }
}

TEST(TwoLevels, EverySingleBoxHasItsOwnRecord) {
  BvhConfig config = kLevels;
  config.boxes = BoxRecords::kSingle;
  const MemoryImage image = build_memory_image(scattered(40), config);
  std::set<std::uint32_t> indices;
  for (const auto& children : image.layout.single_boxes) indices.insert(children.begin(), children.end());
  EXPECT_EQ(indices.size(), 2 * image.nodes.size());
  EXPECT_LT(std::uint64_t{*indices.rbegin()} * image.layout.node_bytes, image.node_array_bytes());
}

TEST(TwoLevels, HybridNumbersAreRefused) {
  BvhConfig config = kLevels;
  config.numbers = BoxNumbers::kHybrid;
  EXPECT_THROW(sim::check_config(config), sim::InputError);
}

/// Returns the scene with all instances moved and one mesh deformed.
Scene moved(Scene scene, float by) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    scene.instances[i].to_world[3].x += by * static_cast<float>(i % 5);
    scene.instances[i].to_world[3].y -= by * static_cast<float>(i % 3);
  }
  for (glm::vec3& p : scene.meshes.back().positions) p *= 1 + by * p.x;
  return scene;
}

Scene deforming() {
  Scene scene = scattered(60);
  scene.meshes.push_back(sphere(8, 12).meshes[0]);
  scene.meshes.back().deformation = std::make_shared<Deformation>();
  scene.instances.push_back({.mesh = 4});
  return scene;
}

TEST(TwoLevels, ARebuildOfAMovedSceneEqualsANewBuild) {
  MemoryImage image = build_memory_image(deforming(), kLevels);
  for (const float by : {0.3F, 0.1F}) {
    const Scene scene = moved(deforming(), by);
    update_memory_image(scene, kLevels, 1, image);
    const MemoryImage fresh = build_memory_image(scene, kLevels);
    EXPECT_EQ(bvh_hash(image), bvh_hash(fresh));
    EXPECT_EQ(image.layout.end, fresh.layout.end);
    EXPECT_EQ(image.lower, fresh.lower);
  }
}

TEST(TwoLevels, ARefittedSceneGivesTheHitsOfEveryTriangle) {
  BvhConfig config = kLevels;
  config.update = BvhUpdate::kRefit;
  MemoryImage image = build_memory_image(deforming(), config);
  update_memory_image(moved(deforming(), 0.3F), config, 1, image);
  const std::vector<Ray> rays = random_rays(2000);
  std::vector<Hit> expected;
  for (const Ray& ray : rays) expected.push_back(test_all(image, ray));
  EXPECT_EQ(count_different(trace(BvhTracer(image), rays), expected), 0U);
  MemoryImage other = build_memory_image(deforming(), config);
  update_memory_image(moved(deforming(), 0.7F), config, 1, other);
  update_memory_image(moved(deforming(), 0.3F), config, 1, other);
  EXPECT_EQ(bvh_hash(image), bvh_hash(other)) << "a refit depends on the last pose alone";
}

TEST(TwoLevels, AnInstanceThatBecomesFlatGetsATreeOfItsOwnAndLosesItAgain) {
  Scene scene = sphere(6, 8);
  scene.instances.resize(3, scene.instances[0]);
  MemoryImage image = build_memory_image(scene, kLevels);
  Scene flat = scene;
  flat.instances[1].to_world[2] = glm::vec4(0);
  update_memory_image(flat, kLevels, 1, image);
  EXPECT_EQ(bvh_hash(image), bvh_hash(build_memory_image(flat, kLevels)));
  update_memory_image(scene, kLevels, 1, image);
  EXPECT_EQ(bvh_hash(image), bvh_hash(build_memory_image(scene, kLevels)));
}

TEST(TwoLevels, TheParentOfAnInstanceIsFound) {
  const MemoryImage image = build_memory_image(scattered(40), kLevels);
  const std::vector<std::uint32_t> parents = parent_indices(image);
  ASSERT_EQ(parents.size(), image.nodes.size() + image.instances.size());
  for (std::uint32_t i = 0; i < image.instances.size(); ++i) {
    if (image.tree_of[i] == kNone) continue;
    const NodeRecord& above = image.nodes[parents[image.nodes.size() + i]];
    EXPECT_EQ(std::ranges::count(above.child, instance_link(i)), 1);
    EXPECT_EQ(parents[image.instances[i].root], image.instances[i].root);
  }
}

}  // namespace
}  // namespace traces
