#include "traces/accel/verify.h"

#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"

namespace traces {
namespace {

/// A faulty tracer, in which `damage` changes every tenth hit.
class BrokenTracer : public Tracer {
 public:
  BrokenTracer(const Tracer& good, std::function<void(Hit&)> damage) : good_(good), damage_(std::move(damage)) {}
  void trace(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits, WalkSink* walk) const override {
    good_.trace(rays, kind, hits, walk);
    for (std::size_t i = 0; i < hits.size(); i += 10) damage_(hits[i]);
  }

 private:
  const Tracer& good_;
  std::function<void(Hit&)> damage_;
};

class Verify : public ::testing::Test {
 protected:
  VerifyCounts with(const Tracer& tested, RayKind kind = RayKind::kPrimary, std::uint32_t rays = 3000) {
    const VerifyingTracer verifying(image_, tested, embree_);
    trace(verifying, random_rays(rays), kind);
    return verifying.verify_counts();
  }

  const MemoryImage image_ = build_memory_image(triangle_soup(800, 0.3F));
  const BvhTracer bvh_{image_};
  const EmbreeTracer embree_{image_, 1};
};

TEST_F(Verify, FindsNothingWrongWithAGoodTracer) {
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow, RayKind::kReflection}) {
    const VerifyCounts counts = with(bvh_, kind, 100000);
    EXPECT_EQ(counts.rays, 100000U);
    EXPECT_EQ(counts.error_count(), 0U);
  }
}

TEST_F(Verify, CountsDroppedHitsAsMissing) {
  const BrokenTracer broken(bvh_, [](Hit& hit) { hit = Hit{}; });
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
    const VerifyCounts counts = with(broken, kind);
    EXPECT_GT(counts.missing_hits, 50U);
    EXPECT_EQ(counts.extra_hits + counts.distance_errors, 0U);
  }
}

TEST_F(Verify, CountsInventedHitsAsExtra) {
  const BrokenTracer broken(bvh_, [](Hit& hit) {
    if (!hit.is_hit()) hit = {1, 0, 0, 5};
  });
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
    const VerifyCounts counts = with(broken, kind);
    EXPECT_GT(counts.extra_hits, 50U);
    EXPECT_EQ(counts.missing_hits + counts.distance_errors, 0U);
  }
}

TEST_F(Verify, CountsWrongDistancesAndWrongTriangles) {
  const BrokenTracer far(bvh_, [](Hit& hit) { hit.t *= 1.001F; });
  EXPECT_GT(with(far).distance_errors, 50U);
  EXPECT_EQ(with(far, RayKind::kShadow).error_count(), 0U);
  const BrokenTracer other(bvh_, [](Hit& hit) {
    if (hit.is_hit()) hit.triangle ^= 1;
  });
  EXPECT_GT(with(other).distance_errors, 50U);
}

TEST_F(Verify, BlamesTheReferenceIfThatIsWrong) {
  const BrokenTracer broken(embree_, [](Hit& hit) { hit = Hit{}; });
  const VerifyingTracer verifying(image_, bvh_, broken);
  trace(verifying, random_rays(3000));
  EXPECT_GT(verifying.verify_counts().reference_errors, 50U);
  EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
}

TEST_F(Verify, ChecksThatFlaggedHitsOfShadowRaysAreNearest) {
  const MemoryImage image = build_memory_image(with_transparent_triangles(triangle_soup(800, 0.3F)));
  const BvhTracer bvh(image);
  const EmbreeTracer embree(image, 1);
  const auto counts_of = [&](std::function<void(Hit&)> damage, RayKind kind) {
    const BrokenTracer broken(bvh, std::move(damage));
    const VerifyingTracer verifying(image, broken, embree);
    trace(verifying, random_rays(20000), kind);
    return verifying.verify_counts();
  };
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
    EXPECT_EQ(counts_of([](Hit&) {}, kind).error_count(), 0U);
  }
  const auto farther = [](Hit& hit) { hit.t *= hit.is_flagged() ? 1.001F : 1; };
  EXPECT_GT(counts_of(farther, RayKind::kShadow).distance_errors, 50U);
  const auto solid = [](Hit& hit) { hit.t *= hit.is_flagged() ? 1 : 1.001F; };
  EXPECT_EQ(counts_of(solid, RayKind::kShadow).error_count(), 0U);
  const auto another = [](Hit& hit) {
    if (hit.is_hit() && !hit.is_flagged()) hit.triangle ^= 1;
  };
  EXPECT_GT(counts_of(another, RayKind::kShadow).error_count(), 10U);
  const auto gone = [](Hit& hit) { hit = Hit{}; };
  EXPECT_GT(counts_of(gone, RayKind::kShadow).missing_hits, 50U);
}

TEST_F(Verify, CallsADifferenceOnAnEdgeATie) {
  const MemoryImage image = build_memory_image(one_triangle());
  const BvhTracer bvh(image);
  const EmbreeTracer embree(image, 1);
  const BrokenTracer broken(bvh, [](Hit& hit) { hit = Hit{}; });
  const auto counts_of = [&](const Ray& ray) {
    const VerifyingTracer verifying(image, broken, embree);
    trace(verifying, {ray});
    return verifying.verify_counts();
  };
  EXPECT_EQ(counts_of(Ray{{0.5F, 0.5F, 1}, 0, {0, 0, -1}}).edge_ties, 1U);
  EXPECT_EQ(counts_of(Ray{{0.25F, 0.25F, 1}, 0, {0, 0, -1}, 1.000001F}).edge_ties, 1U);
  EXPECT_EQ(counts_of(Ray{{0.25F, 0.25F, 1}, 0, {0, 0, -1}}).missing_hits, 1U);
}

TEST_F(Verify, ReturnsTheTestedHitsAndWalks) {
  const std::vector<Ray> rays = random_rays(500);
  std::vector<Hit> expected(rays.size()), hits(rays.size());
  std::vector<std::uint32_t> expected_words, words, expected_begin, begin;
  WalkSink expected_walk{expected_words, expected_begin}, walk{words, begin};
  bvh_.trace(rays, RayKind::kPrimary, expected, &expected_walk);
  VerifyingTracer(image_, bvh_, embree_).trace(rays, RayKind::kPrimary, hits, &walk);
  EXPECT_EQ(words, expected_words);
  EXPECT_EQ(begin, expected_begin);
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(hits[i].triangle, expected[i].triangle);
}

TEST_F(Verify, CountsTheSameFromManyThreads) {
  const BrokenTracer broken(bvh_, [](Hit& hit) { hit = Hit{}; });
  const VerifyCounts alone = with(broken, RayKind::kPrimary, 1000);
  const VerifyingTracer verifying(image_, broken, embree_);
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] { trace(verifying, random_rays(1000)); });
  }
  threads.clear();
  EXPECT_EQ(verifying.verify_counts().rays, 4 * alone.rays);
  EXPECT_EQ(verifying.verify_counts().missing_hits, 4 * alone.missing_hits);
}

TEST(ExactHit, ReportsItsCertainty) {
  const MemoryImage image = build_memory_image(one_triangle());
  const auto certainty = [&](float x, float y) {
    return exact_hit(Ray{{x, y, 1}, 0, {0, 0, -1}}, image, Hit{.triangle = 0}).certainty;
  };
  EXPECT_EQ(certainty(0.25F, 0.25F), Certainty::kHit);
  EXPECT_EQ(certainty(0.25F, 1e-7F), Certainty::kUncertain);
  EXPECT_EQ(certainty(0.25F, -1e-7F), Certainty::kUncertain);
  EXPECT_EQ(certainty(0.25F, -1e-4F), Certainty::kMiss);
  EXPECT_EQ(certainty(0.25F, 1e-4F), Certainty::kHit);
}

}  // namespace
}  // namespace traces
