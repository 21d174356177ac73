#include "traces/walk.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"

namespace traces {
namespace {

/// Replays a recorded traversal on the tree with its own stack. Each word must be valid at its node.
class Replay {
 public:
  Replay(const MemoryImage& image, const std::uint32_t* word) : image_(image), word_(word) {}

  /// Returns the hit bit at the end of the traversal. Sets `phase_hit` if any triangle test reported a hit.
  bool run(bool any_hit, bool& phase_hit) {
    std::uint32_t link = 0;
    while (link != kNoChild) {
      if (is_instance(link)) {
        link = enter(link_instance(link));
      } else if (is_leaf(link)) {
        if (leaf(link, any_hit) && any_hit) break;
        link = pop();
      } else {
        link = visit(link);
      }
      if (::testing::Test::HasFailure()) return false;
    }
    EXPECT_EQ(kind_of(*word_), StepKind::kEnd);
    phase_hit = phase_hit_;
    return (*word_++ & 1U) != 0;
  }
  const std::uint32_t* end() const { return word_; }

 private:
  std::uint32_t visit(std::uint32_t node) {
    EXPECT_EQ(kind_of(*word_), StepKind::kVisit);
    EXPECT_EQ(node_of(*word_), node);
    const std::uint32_t hits = hits_of(*word_), near = near_of(*word_);
    ++word_;
    if (hits == 0) return pop();
    if (hits != 3) {
      EXPECT_EQ(near, 0U);
      return image_.nodes[node].child[hits >> 1];
    }
    stack_.push_back(image_.nodes[node].child[1 - near]);
    return image_.nodes[node].child[near];
  }
  std::uint32_t enter(std::uint32_t instance) {
    EXPECT_EQ(*word_++, instance_step(instance));
    return image_.instances[instance].root;
  }
  bool leaf(std::uint32_t link, bool any_hit) {
    EXPECT_EQ(kind_of(*word_), StepKind::kLeaf);
    EXPECT_EQ(first_of(*word_), leaf_first(link));
    const std::uint32_t count = count_of(*word_++);
    const std::uint32_t phases = *word_++;
    bool hit = false;
    for (std::uint32_t i = 0; i < count; ++i) {
      const ExitPhase phase = phase_of(phases, i);
      EXPECT_GE(phase, ExitPhase::kDistance);
      EXPECT_LE(phase, ExitPhase::kHit);
      if (phase != ExitPhase::kHit) continue;
      phase_hit_ = true;
      hit = !any_hit || image_.triangles[leaf_first(link) + i].hit_flags() == 0;
      if (any_hit && hit) {
        EXPECT_EQ(i + 1, count) << "an any-hit ray goes on after its hit";
      }
    }
    if (count < 8) {
      EXPECT_EQ(phases >> (4 * count), 0U);
    }
    if (any_hit && hit) {
      EXPECT_LE(count, leaf_count(link));
    } else {
      EXPECT_EQ(count, leaf_count(link));
    }
    return hit;
  }
  std::uint32_t pop() {
    if (kind_of(*word_) == StepKind::kCull) {
      const std::uint32_t n = culled_of(*word_++);
      EXPECT_GE(n, 1U);
      EXPECT_LE(n, stack_.size());
      if (n > stack_.size()) return kNoChild;
      stack_.resize(stack_.size() - n);
    }
    if (stack_.empty()) return kNoChild;
    const std::uint32_t link = stack_.back();
    stack_.pop_back();
    return link;
  }

  const MemoryImage& image_;
  const std::uint32_t* word_;
  bool phase_hit_ = false;
  std::vector<std::uint32_t> stack_;
};

struct Recorded {
  std::vector<Hit> hits;
  std::vector<std::uint32_t> words, begin;
};

Recorded record(const MemoryImage& image, const std::vector<Ray>& rays, RayKind kind) {
  Recorded r;
  r.hits.resize(rays.size());
  WalkSink sink{r.words, r.begin};
  BvhTracer(image).trace(rays, kind, r.hits, &sink);
  return r;
}

TEST(Walk, ReplayedAgainstTheTreeItGivesTheSameHits) {
  for (const std::uint32_t leaf_size : {1U, 4U, 8U}) {
    for (const Scene& scene : {triangle_soup(3000, 0.15F), grid_soup(1500), one_triangle(),
                               with_transparent_triangles(triangle_soup(3000, 0.15F)), scattered(60)}) {
      const BvhConfig config{
          .leaf_size = leaf_size,
          .instances = scene.instances.size() > 3 ? InstanceLevels::kTwoLevel : InstanceLevels::kFlatten};
      const MemoryImage image = build_memory_image(scene, config);
      for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
        const Recorded r = record(image, random_rays(5000), kind);
        ASSERT_EQ(r.begin.size(), r.hits.size());
        const std::uint32_t* word = r.words.data();
        for (std::size_t i = 0; i < r.hits.size(); ++i) {
          ASSERT_EQ(word, r.words.data() + r.begin[i]);
          Replay replay(image, word);
          bool phase_hit = false;
          ASSERT_EQ(replay.run(kind == RayKind::kShadow, phase_hit), r.hits[i].is_hit());
          ASSERT_EQ(phase_hit, r.hits[i].is_hit());
          ASSERT_FALSE(HasFailure()) << "ray " << i;
          word = replay.end();
        }
        EXPECT_EQ(word, r.words.data() + r.words.size());
      }
    }
  }
}

TEST(Walk, EntersAnInstanceWithAWordOfItsOwnAndLeavesItWithoutOne) {
  Scene scene = one_triangle();
  scene.instances.resize(3, scene.instances[0]);
  for (std::size_t i = 0; i < 3; ++i) scene.instances[i].to_world[3].z = -2.0F * static_cast<float>(i);
  const MemoryImage image = build_memory_image(scene, {.instances = InstanceLevels::kTwoLevel});
  ASSERT_EQ(image.nodes.size(), 3U) << "two nodes over three instances, and the root of the triangle's tree";
  // Misses the first two triangles, but not their boxes; hits the third.
  const Recorded r = record(image, {Ray{{0.9F, 0.9F, 1}, 0, {-0.1F, -0.1F, -1}}}, RayKind::kPrimary);
  std::vector<std::uint32_t> entered;
  for (const std::uint32_t word : r.words) {
    if (is_enter(word)) entered.push_back(instance_index_of(word));
  }
  EXPECT_EQ(entered, (std::vector<std::uint32_t>{0, 1, 2}));
  ASSERT_TRUE(r.hits[0].is_hit());
  EXPECT_EQ(instance_index_of(r.hits[0]), 2U);
  EXPECT_FLOAT_EQ(r.hits[0].t, 5);
}

TEST(Walk, IsAppendedToTheSink) {
  const MemoryImage image = build_memory_image(triangle_soup(3000, 0.15F));
  const std::vector<Ray> rays = random_rays(600);
  Recorded whole = record(image, rays, RayKind::kPrimary);
  Recorded parts;
  parts.hits.resize(rays.size());
  WalkSink sink{parts.words, parts.begin};
  for (std::size_t i = 0; i < rays.size(); i += 100) {
    BvhTracer(image).trace(std::span(rays).subspan(i, 100), RayKind::kPrimary, std::span(parts.hits).subspan(i, 100),
                           &sink);
  }
  EXPECT_EQ(parts.words, whole.words);
  EXPECT_EQ(parts.begin, whole.begin);
}

TEST(Walk, ARayThatMissesEverythingVisitsTheRootOnly) {
  const MemoryImage image = build_memory_image(triangle_soup(100, 0.1F));
  const Recorded r = record(image, {Ray{{10, 10, 10}, 0, {1, 0, 0}}}, RayKind::kPrimary);
  EXPECT_EQ(r.words, (std::vector<std::uint32_t>{visit_step(0, 0, 0), end_step(false)}));
}

TEST(Walk, NamesThePhaseInWhichEachTestStopped) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0},    // hit at 1
                    {1, 1, 0},  {1, 0, 0},  {0, 1, 0},    // missed, in the same plane
                    {0, 0, -1}, {1, 0, -1}, {0, 1, -1},   // behind the hit
                    {0, 0, 0},  {1, 0, 0},  {1, 0, -1}};  // in a plane that contains the ray
  for (std::uint32_t i = 0; i < 12; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  const MemoryImage image = build_memory_image(scene_of(mesh), {.leaf_size = 8, .traversal_cost = 100});
  ASSERT_EQ(image.nodes[0].child[0], leaf_link(0, 4));
  const std::vector<Ray> rays{Ray{{0.25F, 0.25F, 1}, 0, {0, 0, -1}}};
  EXPECT_EQ(record(image, rays, RayKind::kPrimary).words,
            (std::vector<std::uint32_t>{visit_step(0, 1, 0), leaf_step(0, 4), 0x1123, end_step(true)}));
  EXPECT_EQ(record(image, rays, RayKind::kShadow).words,
            (std::vector<std::uint32_t>{visit_step(0, 1, 0), leaf_step(0, 1), 0x3, end_step(true)}));
}

TEST(Walk, TheChildEnteredFirstIsNearAndChildZeroOfEquals) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 1}, {0, 2, 1}, {0, 0, 0.4F}, {1, 0, 1.4F}, {0, 1, 1.4F}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const MemoryImage image = build_memory_image(scene_of(mesh), {.leaf_size = 1});
  ASSERT_EQ(image.triangles[leaf_first(image.nodes[0].child[0])].source, 0U);
  const auto first_word = [&](float z, float direction) {
    return record(image, {Ray{{0.2F, 0.2F, z}, 0, {0, 0, direction}}}, RayKind::kPrimary).words[0];
  };
  EXPECT_EQ(first_word(-1, 1), visit_step(0, 3, 0));
  EXPECT_EQ(first_word(2, -1), visit_step(0, 3, 1));
  EXPECT_EQ(first_word(0.7F, 1), visit_step(0, 3, 0));
}

TEST(Walk, CullsEntriesBeyondTheHit) {
  const MemoryImage image = build_memory_image(triangle_soup(3000, 0.15F));
  const Recorded r = record(image, random_rays(1000), RayKind::kPrimary);
  std::uint64_t culls = 0;
  for (std::size_t i = 0; i < r.words.size(); ++i) {
    if (kind_of(r.words[i]) == StepKind::kCull) ++culls;
    if (kind_of(r.words[i]) == StepKind::kLeaf) ++i;
  }
  EXPECT_GT(culls, 100U);
}

TEST(CountSteps, CountsNodesAndTrianglesOfWalksBackToBack) {
  // The word of exit phases after a leaf may have any value. An enter step has no second word.
  const std::vector<std::uint32_t> words = {
      visit_step(0, 1, 0), instance_step(0),    visit_step(3, 3, 0), leaf_step(7, 2), 0x33, cull_step(1),
      end_step(true),      visit_step(0, 0, 0), end_step(false),     leaf_step(0, 1), 0x1,  end_step(false)};
  EXPECT_EQ(count_steps(words).visits, 3U);
  EXPECT_EQ(count_steps(words).tests, 2U + 1U);
  EXPECT_EQ(count_steps(words).total_steps(), 3U + 2U + 1U);
}

TEST(CountSteps, CountsAWideVisitOfTwoWordsOnce) {
  // The second word may look like any step.
  const std::vector<std::uint32_t> words = {
      wide_step(0),   wide_hits(0xff, 076543210), wide_step(kMaxNodes - 1), wide_hits(0x40, 6), leaf_step(7, 2), 0x33,
      end_step(false)};
  EXPECT_EQ(count_steps(words).visits, 2U);
  EXPECT_EQ(count_steps(words).tests, 2U);
}

TEST(WideStep, KeepsTheOrderOfHitChildrenAndDiffersFromEveryBinaryVisit) {
  const std::uint32_t hits = wide_hits(0b10010100, 7U << 6 | 2U << 3 | 4U);
  EXPECT_EQ(hit_count_of(hits), 3U);
  EXPECT_EQ(hit_slot_of(hits, 0), 4U);
  EXPECT_EQ(hit_slot_of(hits, 1), 2U);
  EXPECT_EQ(hit_slot_of(hits, 2), 7U);
  EXPECT_TRUE(is_wide(wide_step(5)));
  EXPECT_EQ(node_of(wide_step(5)), 5U);
  EXPECT_EQ(kind_of(wide_step(5)), StepKind::kVisit);
  for (std::uint32_t mask = 0; mask < 4; ++mask) EXPECT_FALSE(is_wide(visit_step(5, mask, mask == 3 ? 1 : 0)));
}

// Tests of traversing trees with boxes in hybrid number format.

constexpr BvhConfig kHybrid{.numbers = BoxNumbers::kHybrid};

/// Returns the number of traversal words of all rays.
std::size_t walk_words(const MemoryImage& image, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint32_t> words, begin;
  WalkSink sink{words, begin};
  BvhTracer(image).trace(rays, RayKind::kPrimary, hits, &sink);
  return words.size();
}

bool same_bits(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Expects the same hits in both images, at the same points of the same triangles; returns their number.
std::size_t expect_same_hits(const Scene& scene, const std::vector<Ray>& rays) {
  const MemoryImage hybrid = build_memory_image(scene, kHybrid), floats = build_memory_image(scene);
  const std::vector<Hit> expected = trace(BvhTracer(floats), rays), found = trace(BvhTracer(hybrid), rays);
  const std::vector<Hit> blocked = trace(BvhTracer(floats), rays, RayKind::kShadow);
  const std::vector<Hit> dark = trace(BvhTracer(hybrid), rays, RayKind::kShadow);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(same_bits(found[i], expected[i])) << i;
    EXPECT_EQ(dark[i].is_hit(), blocked[i].is_hit()) << i;
    EXPECT_EQ(dark[i].is_flagged(), blocked[i].is_flagged()) << i;
    if (blocked[i].is_flagged()) {
      EXPECT_TRUE(same_bits(dark[i], blocked[i])) << i;
    }
    if (::testing::Test::HasFailure()) return 0;
    hits += expected[i].is_hit();
  }
  return hits;
}

TEST(HybridWalk, FindsTheHitsOfFloatsAndNoOthers) {
  for (const Scene& scene : {triangle_soup(3000, 0.15F), grid_soup(1500),
                             with_transparent_triangles(triangle_soup(3000, 0.15F)), sphere(24, 48), one_triangle()}) {
    EXPECT_GT(expect_same_hits(scene, random_rays(20000)), 20U);
    EXPECT_GT(expect_same_hits(scene, grid_rays(20000)), 20U);
  }
  EXPECT_EQ(expect_same_hits(Scene{}, random_rays(100)), 0U);
}

/// Returns rays from distance `far` to points of the cube from -1 to 1; every fourth is parallel to an axis.
std::vector<Ray> rays_from(float far, std::uint32_t count, const glm::vec3& scale = glm::vec3(1),
                           const glm::vec3& offset = glm::vec3(0)) {
  Dice dice(11);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    glm::vec3 direction = dice.direction();
    if (dice.below(4) == 0) {
      direction = glm::vec3(0);
      direction[static_cast<int>(dice.below(3))] = dice.below(2) == 0 ? 1.0F : -1.0F;
    }
    const glm::vec3 at = dice.point();
    ray.origin = (at - far * direction) * scale + offset;
    ray.direction = at * scale + offset - ray.origin;
    if (ray.direction == glm::vec3(0)) ray.direction = {0, 0, 1};
  }
  return rays;
}

TEST(HybridWalk, FindsTheHitsOfFloatsFromFarAway) {
  const Scene scene = triangle_soup(3000, 0.15F);
  for (const float far : {0.0F, 1.0F, 30.0F, 3e3F}) {
    SCOPED_TRACE(far);
    EXPECT_GT(expect_same_hits(scene, rays_from(far, 5000)), 2000U);
  }
}

// From farther away rounding gives hits next to triangles, outside all their boxes. No tree finds all of
// these.
TEST(HybridWalk, LosesNoMoreHitsThanFloatsWhereTheTriangleTestIsCoarserThanBoxes) {
  const Scene scene = triangle_soup(1000, 0.15F);
  const MemoryImage hybrid = build_memory_image(scene, kHybrid), floats = build_memory_image(scene);
  for (const float far : {1e5F, 1e7F, 1e12F}) {
    const std::vector<Ray> rays = rays_from(far, 1000);
    std::vector<Hit> all(rays.size());
    std::ranges::transform(rays, all.begin(), [&](const Ray& ray) { return test_all(floats, ray); });
    const auto found = [&](const MemoryImage& image) {
      const std::vector<Hit> hits = trace(BvhTracer(image), rays);
      std::size_t count = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) count += same_bits(hits[i], all[i]) ? 1 : 0;
      return count;
    };
    EXPECT_GE(found(hybrid), found(floats)) << far;
    EXPECT_GT(found(hybrid), rays.size() * 9 / 10) << far;
  }
}

TEST(HybridWalk, FindsTheHitsOfFloatsInFlatStretchedAndFarScenes) {
  for (const glm::vec3 scale : {glm::vec3(1, 0, 1), glm::vec3(1, 1, 1e-6F), glm::vec3(1e9F), glm::vec3(1e-9F)}) {
    for (const float offset : {0.0F, 100.0F, -1e5F}) {
      SCOPED_TRACE(testing::Message() << scale.x << " " << scale.y << " " << scale.z << " at " << offset);
      Scene scene = triangle_soup(2000, 0.15F);
      for (glm::vec3& p : scene.meshes[0].positions) p = p * scale + offset;
      expect_same_hits(scene,
                       rays_from(3, 3000, scale == glm::vec3(1, 0, 1) ? glm::vec3(1) : scale, glm::vec3(offset)));
    }
  }
}

TEST(HybridWalk, StartsOnPlanesOfBoxesAndOfTheGrid) {
  const Scene scene = triangle_soup(3000, 0.15F);
  const MemoryImage hybrid = build_memory_image(scene, kHybrid), floats = build_memory_image(scene);
  Dice dice(12);
  std::vector<Ray> rays(20000);
  for (Ray& ray : rays) {
    const auto node = dice.below(static_cast<std::uint32_t>(floats.nodes.size()));
    const auto axis = static_cast<int>(dice.below(3));
    const auto lane = dice.below(4);
    const auto plane = [&](const NodeRecord& n) { return (axis == 0 ? n.x : axis == 1 ? n.y : n.z)[lane]; };
    ray.origin = dice.point();
    ray.origin[axis] = dice.below(2) == 0
                           ? plane(floats.nodes[node])
                           : static_cast<float>(hybrid.grid->plane_position(plane(hybrid.nodes[node]), axis));
    ray.direction = dice.direction();
    if (dice.below(2) == 0) ray.direction[axis] = 0;  // in the plane
  }
  EXPECT_GT(expect_same_hits(scene, rays), 10000U);
}

TEST(HybridWalk, IsTheSameInPortableArithmetic) {
  for (const Scene& scene : {triangle_soup(3000, 0.1F), grid_soup(2000), with_transparent_triangles(grid_soup(2000))}) {
    const MemoryImage image = build_memory_image(scene, kHybrid);
    for (const std::vector<Ray>& rays : {random_rays(10000), grid_rays(10000), rays_from(1e4F, 1000)}) {
      EXPECT_EQ(count_different_in_portable(image, rays), 0U);
    }
  }
}

TEST(HybridWalk, AgreesWithEmbree) {
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.2F), kHybrid);
  const BvhTracer bvh(image);
  const EmbreeTracer embree(image, 1);
  const VerifyingTracer verifying(image, bvh, embree);
  trace(verifying, random_rays(50000));
  trace(verifying, random_rays(50000, 9), RayKind::kShadow);
  EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
}

TEST(HybridWalk, IsBarelyLongerThanWithFloats) {
  const Scene scene = triangle_soup(5000, 0.05F);
  const std::vector<Ray> rays = random_rays(20000);
  const auto words = [&](const BvhConfig& config) {
    return static_cast<double>(walk_words(build_memory_image(scene, config), rays));
  };
  EXPECT_NEAR(words(kHybrid) / words({}), 1, 0.002);
}

}  // namespace

}  // namespace traces
