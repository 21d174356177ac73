#include "traces/walk.h"

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"

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

}  // namespace
}  // namespace traces
