#include "traces/trace_file/tile_code.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/accel/support.h"
#include "tests/traces/trace_file/tiny_tile.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/trace_file/bytes.h"

// Tests that the encoding of a tile's work is lossless and compact, and that no bytes decode to a tile that a machine
// cannot execute.

namespace traces {
namespace {

using test::complaint;
using test::decode;
using test::encode;
using test::same;
using test::tile_of_levels;
using test::tiny_levels;
using test::tiny_scope;
using test::tiny_tile;

TEST(TileCode, RestoresATileWithEverything) {
  const TileScope scope = tiny_scope();
  const TileWork tile = tiny_tile();
  TileWork back;
  const TileRays rays = decode(encode(tile, scope.links), scope, back);
  EXPECT_TRUE(same(tile, back));
  EXPECT_EQ(rays.by_kind, (std::array<std::uint64_t, kRayKinds>{3, 2, 0, 0}));
  EXPECT_EQ(rays.steps.total_steps(), 1U + 3 + 3 + 6 + 3 + 1 + 2 + 2) << "visits and tests of the five rays";
}

TEST(TileCode, RestoresRaysThatEnterInstances) {
  const TileScope scope = tiny_levels();
  const TileWork tile = tile_of_levels();
  const std::string bytes = encode(tile, scope.links);
  TileWork back;
  EXPECT_EQ(decode(bytes, scope, back).steps.total_steps(), (5U + 5) + (4 + 1) + 2) << "entering is no step";
  EXPECT_TRUE(same(tile, back));
  TileWork flat = tile;  // a tile without the enter steps
  flat.walk = {visit_step(0, 1, 0), end_step(false)};
  EXPECT_THROW(decode(encode(flat, scope.links), scope, back), sim::InputError);
}

TEST(TileCode, ADecoderReusesItsStorage) {
  const TileScope scope = tiny_scope();
  const TileWork tile = tiny_tile();
  TileWork small;
  small.nodes = {{.items = 1, .inputs = {}}};
  small.access_begin = {0};
  const std::string large_bytes = test::padded(encode(tile, scope.links));
  const std::string small_bytes = test::padded(encode(small, scope.links));
  const auto inside = [](const std::string& bytes) { return std::string_view(bytes).substr(0, bytes.size() - 16); };
  TileDecoder decoder;
  TileWork work;
  decoder.decode_tile(inside(large_bytes), scope, work);
  const Edge* edges = work.nodes[5].inputs.data();
  const std::uint32_t* walk = work.walk.data();
  decoder.decode_tile(inside(small_bytes), scope, work);
  EXPECT_TRUE(same(small, work));
  decoder.decode_tile(inside(large_bytes), scope, work);
  EXPECT_TRUE(same(tile, work));
  EXPECT_EQ(work.walk.data(), walk);
  EXPECT_TRUE(std::ranges::any_of(work.nodes, [&](const WorkNode& n) { return n.inputs.data() == edges; }));
}

TEST(TileCode, WalksThatDoNotFitTheTreeAreRefusedWhenRead) {
  const TileScope scope = tiny_scope();
  TileWork tile = tiny_tile();
  tile.walk[1] = visit_step(2, 0, 0);  // in place of the end
  TileWork back;
  EXPECT_THROW(decode(encode(tile, scope.links), scope, back), sim::InputError);
}

TEST(TileCode, ReferencesOfATileMustExist) {
  const auto without = [](auto&& change) {
    TileScope scope = tiny_scope();
    change(scope);
    return complaint(tiny_tile(), scope);
  };
  EXPECT_EQ(without([](TileScope&) {}), "no error");
  EXPECT_EQ(without([](TileScope& s) { s.kernels = 4; }), "kernel of a launch is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.attributes = 6; }), "an accessed record is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.triangles = 6; }), "an accessed record is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.vertices = 0; }), "an accessed record is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.materials = 1; }), "an accessed record is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.details = 0; }), "an accessed record is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.textures.pop_back(); }), "an accessed texture is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.textures[0] = {63, 32}; }), "an accessed texel is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.counts.textures[1] = {8, 4}; }), "an accessed texel is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.region_bytes[0] = 4095; }), "bytes of a transfer is out of range");
  EXPECT_EQ(without([](TileScope& s) { s.region_bytes[2] = 0; }), "bytes of a transfer is out of range");
}

TEST(TileCode, EnteredInstancesMustExist) {
  const auto changed = [](std::size_t word, std::uint32_t to) {
    TileWork tile = tile_of_levels(), back;
    tile.walk[word] = to;
    try {
      decode(encode(tile, tiny_levels().links), tiny_levels(), back);
    } catch (const sim::InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const std::string none = "a ray's walk is none on this tree";
  EXPECT_EQ(changed(1, instance_step(2)), "no error");
  EXPECT_EQ(changed(1, instance_step(0)), none) << "not the one below this node";
  EXPECT_EQ(changed(1, instance_step(4)), none) << "there is none";
  EXPECT_EQ(changed(1, visit_step(2, 2, 0)), none) << "without entering";
  EXPECT_EQ(changed(2, visit_step(4, 2, 0)), none) << "another tree's root";
  EXPECT_EQ(changed(10, visit_step(4, 3, 0)), none) << "a child that is not there";
  TileScope fewer = tiny_levels();
  fewer.counts.instances = 1;
  TileWork back;
  EXPECT_THROW(decode(encode(tile_of_levels(), fewer.links), fewer, back), sim::InputError);
}

TEST(TileCode, AGraphThatAMachineCouldNotExecuteIsRefused) {
  const auto changed = [](auto&& change) {
    TileWork tile = tiny_tile();
    change(tile);
    return complaint(tile, tiny_scope());
  };
  EXPECT_EQ(complaint(TileWork(), tiny_scope()), "number of nodes is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.nodes[1].items = 0; }), "items of a node is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.nodes[6].inputs[0].node = 6; }), "input of a node is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.nodes[1].items = 2; }), "input of a node is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.nodes[1].items = 4; }),
            "rays without sources must be as many as the items that make them");
  EXPECT_EQ(changed([](TileWork& t) { t.sources = {0, 3}; }), "source of a ray is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.sources = {2, 0}; }), "source of a ray is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.imports[0].number = kMostBorders; }),
            "number of an imported border is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.imports.resize(kMostImports + 1); }),
            "borders that a tile imports is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.nodes[0].border = 1; }), "border of a transfer is out of range");
  EXPECT_EQ(changed([](TileWork& t) { t.imports.push_back({5, 0}); }), "no transfer reads border 1");
  EXPECT_EQ(changed([](TileWork& t) { t.nodes[6].border = kMostBorders; }), "border of a transfer is out of range");
  EXPECT_EQ(changed([](TileWork& t) {
              t.nodes[2].inputs.push_back({0, Edge::Kind::kAll});
            }),
            "rays must have one input, an `each` edge from a launch");
}

TEST(TileCode, RaysWithoutReadersAreRefused) {
  TileWork tile = tiny_tile();
  tile.nodes[5].inputs = {{2, Edge::Kind::kAll}};
  EXPECT_EQ(complaint(tile, tiny_scope()), "no node reads the hits of node 4");
  tile.nodes[5].items = tile.nodes[4].items - 1;
  tile.nodes[5].inputs = {{4, Edge::Kind::kEach}};
  EXPECT_EQ(complaint(tile, tiny_scope()), "no node reads all hits of node 4");
}

TEST(TileCode, AForgedNumberOfWordsTakesNoMemory) {
  std::string bytes;
  ByteWriter to(bytes);
  constexpr std::uint32_t kBytes = 4U << 20;
  for (const std::uint32_t number : {/*frame*/ 0U, /*tile*/ 0U, /*samples*/ 4U, /*after all*/ 0U, /*imports*/ 0U,
                                     /*nodes*/ 0U, /*rays*/ 0U, /*words*/ 8 * kBytes, /*bits*/ 0U}) {
    to.write_number(number);
  }
  bytes.resize(bytes.size() + kBytes);
  TileWork back;
  EXPECT_THROW(decode(bytes, tiny_scope(), back), sim::InputError);
  EXPECT_LE(back.walk.capacity(), kBytes / 4) << "words of four bytes: no more than the tile has itself";
}

TEST(TileCode, ATileHasALimitedNumberOfNodes) {
  TileWork tile;
  tile.nodes.resize(kMaxTileNodes, {.items = 1, .inputs = {}});
  tile.access_begin = {0};
  std::string bytes;
  TileEncoder().encode_tile(tile, tiny_scope().links, bytes);
  TileWork back;
  decode(bytes, tiny_scope(), back);
  EXPECT_EQ(back.nodes.size(), kMaxTileNodes);
  tile.nodes.push_back(tile.nodes.back());
  EXPECT_THROW(encode(tile, tiny_scope().links), sim::InputError);
  // One more import: its entry comes after frame, number, samples and after_all.
  std::string number, more;
  ByteWriter(number).write_number(kMaxTileNodes);
  ByteWriter(more).write_number(kMaxTileNodes + 1);
  ASSERT_EQ(bytes.find(number), 5U);
  bytes.replace(5, number.size(), more);
  bytes.insert(5 + more.size(), std::string("\0\1\0\0\0\0", 6));
  try {
    decode(bytes, tiny_scope(), back);
    FAIL();
  } catch (const sim::InputError& error) {
    EXPECT_STREQ(error.what(), "number of nodes is out of range");
  }
}

/// Damages a valid tile in many ways, and expects a valid tile or an error message each time.
void expect_tile_or_complaint(const TileScope& scope, const TileWork& tile) {
  const std::string good = encode(tile, scope.links);
  TileWork back;
  std::size_t accepted = 0;
  const auto attempt = [&](const std::string& bytes) {
    try {
      decode(bytes, scope, back);
    } catch (const sim::InputError&) {
      return;
    }
    ++accepted;
    TileWork again;
    decode(encode(back, scope.links), scope, again);
    EXPECT_TRUE(same(back, again)) << "what is accepted is a tile";
  };
  for (std::size_t size = 0; size < good.size(); ++size) attempt(good.substr(0, size));
  EXPECT_EQ(accepted, 0U) << "a piece of a tile is none";
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string bad = good;
      bad[i] = static_cast<char>(static_cast<unsigned char>(bad[i]) ^ (1U << bit));
      attempt(bad);
    }
  }
  Dice dice(7);
  for (int n = 0; n < 20000; ++n) {
    std::string bad = good;
    for (std::uint32_t changes = 1 + dice.below(4); changes > 0; --changes) {
      bad[dice.below(static_cast<std::uint32_t>(bad.size()))] = static_cast<char>(dice.below(256));
    }
    attempt(bad);
  }
  EXPECT_GT(accepted, 100U) << "otherwise only the first check has been tried";
}

TEST(TileCode, AnyBytesGiveAValidTileOrAnError) { expect_tile_or_complaint(tiny_scope(), tiny_tile()); }

TEST(TileCode, AnyBytesOfTwoLevelsGiveAValidTileOrAnError) {
  expect_tile_or_complaint(tiny_levels(), tile_of_levels());
}

/// Returns a tile with rays through a scene.
TileWork rays_through(const MemoryImage& image, RayKind kind, const std::vector<Ray>& rays) {
  TileWork tile;
  const auto count = static_cast<std::uint32_t>(rays.size());
  tile.nodes = {{.items = count, .inputs = {}},
                {.kind = WorkNode::Kind::kRays, .ray_kind = kind, .items = count, .inputs = {{0, Edge::Kind::kEach}}},
                {.items = 1, .inputs = {{1, Edge::Kind::kAll}}}};
  tile.access_begin = {0};
  std::vector<Hit> hits(rays.size());
  WalkSink sink{tile.walk, tile.ray_begin};
  BvhTracer(image).trace(rays, kind, hits, &sink);
  return tile;
}

TEST(TileCode, WalksAreRestoredAndTakeAFewBitsPerStep) {
  const std::vector<Scene> scenes = {with_transparent_triangles(triangle_soup(2000, 0.3F)), grid_soup(500),
                                     one_triangle(), sphere(40, 80)};
  for (const Scene& scene : scenes) {
    for (const std::uint32_t leaf_size : {1U, 8U}) {
      const MemoryImage image = build_memory_image(scene, {.leaf_size = leaf_size}, 1);
      const TileScope scope{links_of(image), counts_of(image), 1, {}};
      for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
        for (const auto& rays : {random_rays(500), grid_rays(500)}) {
          const TileWork tile = rays_through(image, kind, rays);
          const std::string bytes = encode(tile, scope.links);
          TileWork back;
          decode(bytes, scope, back);
          ASSERT_TRUE(same(tile, back));
          EXPECT_LT(bytes.size(), tile.walk.size() + 32) << "a byte a word, and what is beside walks";
        }
      }
    }
  }
}

TEST(TileCode, WalksThroughInstancesAreRestoredAndEntersTakeNoBits) {
  for (const Scene& scene : {scattered(80), scattered(1), with_transparent_triangles(triangle_soup(2000, 0.3F))}) {
    const MemoryImage image = build_memory_image(scene, {.instances = InstanceLevels::kTwoLevel}, 1);
    const TileScope scope{links_of(image), counts_of(image), 1, {}};
    for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
      const TileWork tile = rays_through(image, kind, random_rays(500));
      const auto entered = static_cast<std::size_t>(std::ranges::count_if(tile.walk, is_enter));
      const std::string bytes = encode(tile, scope.links);
      TileWork back;
      decode(bytes, scope, back);
      ASSERT_TRUE(same(tile, back));
      EXPECT_LT(bytes.size(), tile.walk.size() - entered + 32);
    }
  }
}

/// Expects that walks through a wide tree are restored, and that any change of their bytes gives a valid tile or an
/// error.
void expect_wide_walks(const Scene& scene, const BvhConfig& config) {
  const MemoryImage image = build_memory_image(scene, config, 1);
  const TileScope scope{links_of(image), counts_of(image), 1, {}};
  EXPECT_EQ(scope.links.slots, config.format == NodeFormat::kCw80 ? 8 : config.width);
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
    for (const auto& rays : {random_rays(500), grid_rays(500)}) {
      const TileWork tile = rays_through(image, kind, rays);
      const std::string bytes = encode(tile, scope.links);
      TileWork back;
      decode(bytes, scope, back);
      ASSERT_TRUE(same(tile, back));
      EXPECT_LT(bytes.size(), tile.walk.size() + 32) << "a byte a word";
    }
  }
  expect_tile_or_complaint(scope, rays_through(image, RayKind::kPrimary, random_rays(30)));
}

TEST(TileCode, WalksThroughWideTreesAreRestored) {
  for (const std::uint32_t width : {2U, 4U, 6U, 8U}) {
    for (const NodeFormat format : {NodeFormat::kFp32, NodeFormat::kQ8, NodeFormat::kCw80}) {
      if (width == 2 && format == NodeFormat::kFp32) continue;
      SCOPED_TRACE(testing::Message() << width << " " << names_of(format)[static_cast<std::size_t>(format)]);
      expect_wide_walks(with_transparent_triangles(triangle_soup(1000, 0.3F)),
                        {.leaf_size = 3, .width = width, .format = format});
      expect_wide_walks(scattered(80),
                        {.leaf_size = 3, .instances = InstanceLevels::kTwoLevel, .width = width, .format = format});
    }
  }
}

TEST(TileCode, WideWalksThatTheTreeDoesNotAllowAreStoredAsWordsAndRefused) {
  const MemoryImage image = build_memory_image(triangle_soup(50, 0.3F), {.width = 4}, 1);
  const TileScope scope{links_of(image), counts_of(image), 1, {}};
  const TileWork good = rays_through(image, RayKind::kPrimary, {{{0.1F, 0.2F, -4}, 0, {0, 0, 1}}});
  ASSERT_EQ(good.walk[0], wide_step(0));
  ASSERT_GT(hit_count_of(good.walk[1]), 1U);
  const auto is_refused = [&](std::uint32_t word, std::uint32_t value) {
    TileWork bad = good;
    bad.walk[word] = value;
    TileWork back;
    EXPECT_THROW(decode(encode(bad, scope.links), scope, back), sim::InputError);
  };
  const std::uint32_t mask = hit_mask_of(good.walk[1]);
  is_refused(0, visit_step(0, 1, 0));                                // a binary visit
  is_refused(0, wide_step(1));                                       // another node
  is_refused(1, wide_hits(mask | 0x10, 0));                          // a slot that the tree has not
  is_refused(1, wide_hits(mask, hit_slot_of(good.walk[1], 0) * 9));  // a slot twice
  is_refused(1, good.walk[1] | 7U << 21);                            // a slot after the hit ones
}

// Tests of the encoding of accesses to regions kSamples and kBuild.

/// Returns a tile with one launch whose two items read the given words of region kSamples.
TileWork tile_that_reads(std::uint32_t first, std::uint32_t second) {
  TileWork tile;
  tile.nodes = {{.items = 2, .first = 0, .has_accesses = true, .inputs = {}}};
  tile.accesses = {Access::of_kind(Access::Kind::kStored, first), Access::of_kind(Access::Kind::kStored, second)};
  tile.access_begin = {0, 1, 2};
  return tile;
}

TEST(StoredAccess, RestoresWordsOfTheRegion) {
  const TileScope scope = test::tiny_scope();  // 512 bytes of samples
  const TileWork tile = tile_that_reads(127, 3);
  TileWork back;
  test::decode(test::encode(tile, scope.links), scope, back);
  EXPECT_TRUE(test::same(tile, back));
}

TEST(StoredAccess, RefusesWordsOutsideTheRegion) {
  const TileScope scope = test::tiny_scope();
  TileWork back;
  EXPECT_THROW(test::decode(test::encode(tile_that_reads(3, 128), scope.links), scope, back), sim::InputError);
}

TEST(StoredAccess, ReachesRecordsOfKernelsThatBuildTrees) {
  TileScope scope = test::tiny_scope();  // a line of rates
  scope.region_bytes[static_cast<std::size_t>(Region::kBuild)] = 64;
  constexpr std::uint32_t kWords = (512 + 64 + 64) / kStoredWordBytes;
  const TileWork tile = tile_that_reads(3, kWords - 1);
  TileWork back;
  test::decode(test::encode(tile, scope.links), scope, back);
  EXPECT_TRUE(test::same(tile, back));
  EXPECT_THROW(test::decode(test::encode(tile_that_reads(3, kWords), scope.links), scope, back), sim::InputError);
}

}  // namespace
}  // namespace traces
