#include <vector>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/traces/accel/support.h"
#include "tests/traces/trace_file/tiny_tile.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"

// Tests of stored walks that begin with look-ups of predicted nodes.

namespace traces {
namespace {

using test::decode, test::encode, test::same;

/// Returns a tile of shadow rays with look-ups. The table has learnt from the same rays.
TileWork tile_with_look_ups(const MemoryImage& image, const std::vector<Ray>& rays) {
  const PredictorConfig config{.enabled = true, .origin_bits = 3};
  const BvhTracer tracer(image, config);
  PredictorTable table(config);
  TileWork tile;
  std::vector<Hit> hits(rays.size());
  for (int round = 0; round < 2; ++round) {
    TilePredictions predictions(*tracer.ray_predictor(), table);
    tile = {};
    WalkSink sink{tile.walk, tile.ray_begin, &predictions};
    tracer.trace(rays, RayKind::kShadow, hits, &sink);
    for (const PredictorUpdate& update : predictions.updates()) table.apply_update(update);
  }
  const auto count = static_cast<std::uint32_t>(rays.size());
  tile.nodes = {
      {.items = count, .inputs = {}},
      {.kind = WorkNode::Kind::kRays, .ray_kind = RayKind::kShadow, .items = count, .inputs = {{0, Edge::Kind::kEach}}},
      {.items = 1, .inputs = {{1, Edge::Kind::kAll}}}};
  tile.access_begin = {0};
  return tile;
}

TileScope scope_of(const MemoryImage& image) {
  TileScope scope{links_of(image), counts_of(image), 1, {}};
  scope.look_ups = true;
  return scope;
}

TEST(LookUpCode, WalksAreRestoredAndTakeAFewBitsPerStep) {
  for (const std::uint32_t width : {2U, 4U, 8U}) {
    const MemoryImage image =
        build_memory_image(with_transparent_triangles(triangle_soup(2000, 0.3F)), {.width = width}, 1);
    const TileScope scope = scope_of(image);
    const TileWork tile = tile_with_look_ups(image, random_rays(500));
    std::uint64_t correct = 0, wrong = 0, none = 0;
    for (const std::uint32_t at : tile.ray_begin) {
      ASSERT_TRUE(is_look_up(tile.walk[at]));
      const bool found = node_of(tile.walk[at]) != kNoPrediction, is_correct = is_correct_look_up(tile.walk[at]);
      (!found ? none : is_correct ? correct : wrong) += 1;
    }
    EXPECT_GT(correct, 0U);
    EXPECT_GT(wrong, 0U);
    EXPECT_GT(none, 0U);
    const std::string bytes = encode(tile, scope.links);
    TileWork back;
    const TileRays rays = decode(bytes, scope, back);
    EXPECT_TRUE(same(tile, back));
    EXPECT_EQ(rays.steps.visits, count_steps(tile.walk).visits);
    EXPECT_LT(bytes.size(), tile.walk.size() + 2000) << "a byte a word, and four for each look-up";
  }
}

TEST(LookUpCode, IsRefusedWithoutAPredictor) {
  const MemoryImage image = build_memory_image(triangle_soup(200, 0.3F), {}, 1);
  TileScope scope = scope_of(image);
  const std::string bytes = encode(tile_with_look_ups(image, random_rays(20)), scope.links);
  scope.look_ups = false;
  TileWork back;
  EXPECT_THROW(decode(bytes, scope, back), sim::InputError);
}

TEST(LookUpCode, WalksWithoutLookUpsAreStoredAsBefore) {
  const MemoryImage image = build_memory_image(triangle_soup(200, 0.3F), {}, 1);
  const TileWork tile = tile_with_look_ups(image, random_rays(50));
  TileWork plain = tile;
  std::vector<Hit> hits(50);
  plain.walk.clear();
  plain.ray_begin.clear();
  WalkSink sink{plain.walk, plain.ray_begin};
  BvhTracer(image).trace(random_rays(50), RayKind::kShadow, hits, &sink);
  TileScope scope = scope_of(image);
  const std::string bytes = encode(plain, scope.links);
  for (const bool look_ups : {false, true}) {
    scope.look_ups = look_ups;
    TileWork back;
    decode(bytes, scope, back);
    EXPECT_TRUE(same(plain, back));
  }
}

TEST(LookUpCode, DamagedWalksAreRefusedOrPossible) {
  const MemoryImage image = build_memory_image(triangle_soup(60, 0.3F), {}, 1);
  const TileScope scope = scope_of(image);
  const std::string good = encode(tile_with_look_ups(image, random_rays(40)), scope.links);
  std::uint32_t refused = 0;
  for (std::uint32_t i = 0; i < 8 * good.size(); ++i) {
    std::string bad = good;
    bad[i / 8] = static_cast<char>(bad[i / 8] ^ (1 << i % 8));
    TileWork back;
    try {
      decode(bad, scope, back);
    } catch (const sim::InputError&) {
      refused += 1;
      continue;
    }
    // A walk that was accepted is possible on the tree: it can be stored again, as bits.
    TileWork again;
    decode(encode(back, scope.links), scope, again);
    EXPECT_TRUE(same(back, again)) << i;
  }
  EXPECT_GT(refused, good.size());
}

TEST(LookUpCode, RefusesWalksThatContradictTheirLookUp) {
  const MemoryImage image = build_memory_image(triangle_soup(60, 0.3F), {}, 1);
  const TileScope scope = scope_of(image);
  const TileWork tile = tile_with_look_ups(image, random_rays(200));
  std::uint32_t tried = 0;
  for (std::size_t ray = 0; ray < tile.ray_begin.size() && tried < 6; ++ray) {
    const std::uint32_t at = tile.ray_begin[ray], word = tile.walk[at];
    if (node_of(word) == kNoPrediction) continue;
    ++tried;
    const auto is_refused = [&](std::uint32_t value) {
      TileWork bad = tile, back;
      bad.walk[at] = value;
      EXPECT_THROW(decode(encode(bad, scope.links), scope, back), sim::InputError);
    };
    is_refused(look_up_step(node_of(word), !is_correct_look_up(word), stores_hit(word)));
    is_refused(look_up_step(0, is_correct_look_up(word), stores_hit(word)));
    is_refused(look_up_step(kMaxNodes - 2, is_correct_look_up(word), stores_hit(word)));
    is_refused(look_up_step(kNoPrediction, is_correct_look_up(word), stores_hit(word)));
  }
  EXPECT_EQ(tried, 6U);
}

}  // namespace
}  // namespace traces
