#include "traces/accel/ray_predictor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/walk.h"

namespace traces {
namespace {

constexpr PredictorConfig kEnabled{.enabled = true, .ray_lag = 65536};

/// Shadow rays traced with look-ups, and what they record.
struct PredictedRays {
  std::vector<std::uint32_t> words, begin;
  std::vector<PredictorUpdate> updates;
  std::vector<Hit> hits;

  PredictedRays(const BvhTracer& tracer, const PredictorTable& table, const std::vector<Ray>& rays)
      : hits(rays.size()) {
    TilePredictions predictions(*tracer.ray_predictor(), table);
    WalkSink sink{words, begin, &predictions};
    tracer.trace(rays, RayKind::kShadow, hits, &sink);
    updates.assign(predictions.updates().begin(), predictions.updates().end());
  }
  std::uint32_t look_up(std::size_t ray) const { return words[begin[ray]]; }
  std::uint64_t count_correct() const {
    return static_cast<std::uint64_t>(
        std::ranges::count_if(begin, [&](std::uint32_t at) { return is_correct_look_up(words[at]); }));
  }
};

PredictorTable table_after(const std::vector<PredictorUpdate>& updates, const PredictorConfig& config = kEnabled) {
  PredictorTable table(config);
  for (const PredictorUpdate& update : updates) table.apply_update(update);
  return table;
}

TEST(PredictorTable, ReplacesTheLeastRecentlyUsedEntryOfASet) {
  const PredictorConfig config{.entries = 8, .ways = 4};  // two sets, selected by the parity of the hash
  PredictorTable table(config);
  for (const std::uint32_t hash : {0U, 3U, 5U, 6U}) table.apply_update({hash, 100 + hash});
  table.apply_update({1, 101});  // another set
  table.apply_update({0, 200});  // the oldest becomes the youngest
  table.apply_update({9, 109});  // replaces 3
  EXPECT_EQ(table.find_node(0), 200U);
  EXPECT_EQ(table.find_node(3), kNone);
  for (const std::uint32_t hash : {5U, 6U, 1U, 9U}) EXPECT_EQ(table.find_node(hash), 100 + hash) << hash;
  EXPECT_EQ(table.find_node(2), kNone);
  table.apply_update({5, kNone});  // a look-up that found 5, now the oldest
  table.apply_update({3, kNone});  // not in the table: nothing changes
  table.apply_update({3, 103});    // replaces 6
  EXPECT_EQ(table.find_node(5), 105U);
  EXPECT_EQ(table.find_node(6), kNone);
}

TEST(PredictorTable, HasFiveAndAHalfKibibytes) { EXPECT_EQ(kEnabled.sram_bytes(), 5632U); }

TEST(RayPredictor, HashesDirectionsToSectorsOf22Degrees) {
  const MemoryImage image = build_memory_image(sphere(8, 16), {}, 1);
  const RayPredictor predictor(image, kEnabled);
  std::set<std::uint32_t> hashes;
  for (std::uint32_t polar = 0; polar < 8; ++polar) {
    for (std::uint32_t azimuth = 0; azimuth < 16; ++azimuth) {
      const double theta = (polar + 0.5) * std::numbers::pi / 8, phi = (azimuth + 0.5) * std::numbers::pi / 8;
      const glm::vec3 direction(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      for (const float length : {0.01F, 1.0F, 30.0F}) {
        const Ray ray{image.lower - glm::vec3(1), 0, length * direction};
        EXPECT_EQ(predictor.hash_of(ray), polar << 4 | azimuth) << polar << " " << azimuth;
        hashes.insert(predictor.hash_of(ray));
      }
    }
  }
  EXPECT_EQ(hashes.size(), 128U);
}

TEST(RayPredictor, HashesOriginsToCellsOfAGridOverTheScene) {
  const MemoryImage image = build_memory_image(sphere(8, 16), {}, 1);
  const RayPredictor predictor(image, kEnabled);
  const auto cell_of = [&](const glm::vec3& at) {
    const glm::vec3 origin = image.lower + (image.upper - image.lower) * at;
    return predictor.hash_of({origin, 0, {0.1F, 1, 0.01F}});  // sector 0
  };
  for (std::uint32_t i = 0; i < 32; ++i) {
    const float at = (static_cast<float>(i) + 0.5F) / 32;
    EXPECT_EQ(cell_of({at, 0.01F, 0.01F}), i);
    EXPECT_EQ(cell_of({0.01F, at, 0.01F}), i << 5);
    EXPECT_EQ(cell_of({0.01F, 0.01F, at}), i << 10);
  }
  EXPECT_EQ(cell_of({-3, 0.01F, 9}), 31U << 10) << "origins outside the scene are in its outer cells";
}

TEST(RayPredictor, StoresTheNodeGoUpLevelsAboveTheLeafButNotTheRoot) {
  const MemoryImage image = build_memory_image(triangle_soup(500, 0.1F), {.leaf_size = 1}, 1);
  const std::vector<std::uint32_t> parents = parent_indices(image);
  for (const std::uint32_t go_up : {1U, 2U, 3U, 16U}) {
    const RayPredictor predictor(image, {.enabled = true, .go_up = go_up});
    for (std::uint32_t node = 1; node < image.node_count(); ++node) {
      for (const std::uint32_t link : image.links_of(node)) {
        if (!is_leaf(link)) continue;
        std::vector<std::uint32_t> path;  // from the leaf's parent to a child of the root
        for (std::uint32_t at = node; at != 0; at = parents[at]) path.push_back(at);
        EXPECT_EQ(predictor.node_to_store(leaf_first(link)), path[std::min<std::size_t>(go_up, path.size()) - 1]);
      }
    }
  }
}

TEST(RayPredictor, PredictsTheSecondOfIdenticalRays) {
  const MemoryImage image = build_memory_image(triangle_soup(3000, 0.2F), {.leaf_size = 1}, 1);
  const BvhTracer tracer(image, kEnabled);
  const std::vector<Ray> rays = random_rays(200);
  const PredictedRays first(tracer, PredictorTable(kEnabled), rays);
  std::size_t predicted = 0, update = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool is_hit = first.hits[i].is_hit();
    ASSERT_EQ(first.look_up(i), look_up_step(kNoPrediction, false, is_hit)) << "the table is empty";
    if (!is_hit) continue;
    const PredictedRays second(tracer, table_after({first.updates[update]}), {rays[i]});
    const std::uint32_t node = first.updates[update].node;
    EXPECT_EQ(second.look_up(0), look_up_step(node, true, false)) << "a correct prediction updates nothing";
    EXPECT_EQ(second.updates, (std::vector<PredictorUpdate>{{first.updates[update].hash, kNone}}));
    EXPECT_EQ(second.words[1], visit_step(node, hits_of(second.words[1]), near_of(second.words[1])));
    const std::size_t end = i + 1 == rays.size() ? first.words.size() : first.begin[i + 1];
    EXPECT_LT(second.words.size(), end - first.begin[i]);
    EXPECT_EQ(second.hits[0].triangle, first.hits[i].triangle) << "the order within the subtree is the same";
    ++predicted, ++update;
  }
  EXPECT_GT(predicted, 30U);
  EXPECT_EQ(update, first.updates.size());
}

TEST(RayPredictor, PredictsTheRaysOfATileFromItsRayLagOn) {
  const MemoryImage image = build_memory_image(triangle_soup(3000, 0.2F), {.leaf_size = 1}, 1);
  std::vector<Hit> hits = trace(BvhTracer(image), random_rays(200), RayKind::kShadow);
  const auto blocked = std::ranges::find_if(hits, &Hit::is_hit) - hits.begin();
  const std::vector<Ray> same(10, random_rays(200)[static_cast<std::size_t>(blocked)]);
  for (const std::uint32_t lag : {1U, 4U, 20U}) {
    const BvhTracer tracer(image, {.enabled = true, .ray_lag = lag});
    const PredictedRays rays(tracer, PredictorTable(kEnabled), same);
    for (std::uint32_t i = 0; i < same.size(); ++i) EXPECT_EQ(is_correct_look_up(rays.look_up(i)), i >= lag) << i;
  }
}

TEST(RayPredictor, AWrongPredictionIsFollowedByTheWholeWalk) {
  const MemoryImage image = build_memory_image(triangle_soup(300, 0.2F), {.leaf_size = 1}, 1);
  const BvhTracer tracer(image, kEnabled);
  const std::vector<Ray> rays = random_rays(300);
  const PredictedRays plain(tracer, PredictorTable(kEnabled), rays);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::uint32_t node = 1 + static_cast<std::uint32_t>(i % (image.node_count() - 1));
    const PredictedRays other(tracer, table_after({{tracer.ray_predictor()->hash_of(rays[i]), node}}), {rays[i]});
    EXPECT_EQ(other.hits[0].is_hit(), plain.hits[i].is_hit());
    ASSERT_EQ(node_of(other.look_up(0)), node);
    ASSERT_EQ(node_of(other.words[1]), node);
    if (is_correct_look_up(other.look_up(0))) continue;
    wrong += 1;
    const auto end = i + 1 == rays.size() ? plain.words.end() : plain.words.begin() + plain.begin[i + 1];
    const std::vector<std::uint32_t> whole(plain.words.begin() + plain.begin[i] + 1, end);
    ASSERT_GT(other.words.size(), whole.size());
    EXPECT_TRUE(std::equal(whole.rbegin(), whole.rend(), other.words.rbegin()));
  }
  EXPECT_GT(wrong, 100U);
}

/// Expects that predictions change no result of rays, except that an opaque triangle may be found where a flagged one
/// is nearer. The table learns in the first round.
void expect_same_results(const Scene& scene, const BvhConfig& config, const std::vector<Ray>& rays) {
  const MemoryImage image = build_memory_image(scene, config, 1);
  const BvhTracer plain(image), tracer(image, kEnabled);
  const std::vector<Hit> truth = trace(plain, rays, RayKind::kShadow);
  PredictorTable table(kEnabled);
  std::uint64_t correct = 0;
  for (int round = 0; round < 2; ++round) {
    const PredictedRays predicted(tracer, table, rays);
    for (const PredictorUpdate& update : predicted.updates) table.apply_update(update);
    correct += predicted.count_correct();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit& hit = predicted.hits[i];
      EXPECT_EQ(hit.is_hit(), truth[i].is_hit());
      if (!is_correct_look_up(predicted.look_up(i))) {
        EXPECT_EQ(hit.triangle, truth[i].triangle);
        EXPECT_EQ(hit.t, truth[i].t);
      } else if (truth[i].is_flagged()) {
        EXPECT_FALSE(hit.is_flagged());
        EXPECT_GE(hit.t, truth[i].t) << "the flagged hit is the nearest";
      }
    }
  }
  EXPECT_GT(correct, 0U);
}

TEST(RayPredictor, ChangesNoResultOnAnyTree) {
  for (const std::uint32_t width : {2U, 8U}) {
    for (const NodeFormat format : {NodeFormat::kFp32, NodeFormat::kQ8}) {
      const BvhConfig config{.leaf_size = 2, .width = width, .format = format};
      SCOPED_TRACE(testing::Message() << width << " " << names_of(format)[static_cast<std::size_t>(format)]);
      expect_same_results(triangle_soup(500, 0.2F), config, random_rays(300));
      expect_same_results(with_transparent_triangles(triangle_soup(800, 0.3F)), config, random_rays(300));
      expect_same_results(single_sided(grid_soup(300)), config, grid_rays(300));
    }
  }
}

TEST(PredictorHistory, GivesEachTileTheTableAfterTheTileBeforeItsLag) {
  const MemoryImage image = build_memory_image(triangle_soup(50, 0.2F), {}, 1);
  for (const std::uint32_t lag : {1U, 2U, 5U}) {
    const RayPredictor predictor(image, {.enabled = true, .lag = lag});
    PredictorHistory history(predictor);
    constexpr std::uint32_t kTiles = 20;
    for (std::uint32_t tile = 0; tile < kTiles; ++tile) {
      EXPECT_EQ(history.end_of_startable(), tile + lag);
      for (std::uint32_t started = tile; started < tile + lag; ++started) {  // tiles may start in any order
        const PredictorTable& table = history.table_of(started);
        for (std::uint32_t earlier = 0; earlier < kTiles; ++earlier) {
          EXPECT_EQ(table.find_node(earlier), earlier + lag <= started ? 1000 + earlier : kNone);
        }
      }
      history.commit_tile(std::vector<PredictorUpdate>{{tile, 1000 + tile}});
    }
  }
}

}  // namespace
}  // namespace traces
