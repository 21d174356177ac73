#include <functional>

#include <gtest/gtest.h>

#include "tests/traces/trace_file/tiny_tile.h"

// Tests of encoding a rasteriser's work.

namespace traces {
namespace {

using test::complaint;
using test::decode;
using test::encode;
using test::same;
using test::tile_of_raster;
using test::tiny_raster;
using test::tiny_scope;

TEST(RasterCode, RestoresABatchAndAWave) {
  const TileScope scope = tiny_raster();
  const TileWork tile = tile_of_raster();
  TileWork back;
  decode(encode(tile, scope.links), scope, back);
  EXPECT_TRUE(same(tile, back));
  // Decodes again into the storage of an earlier tile.
  decode(encode(tile, scope.links), scope, back);
  EXPECT_TRUE(same(tile, back));
}

TEST(RasterCode, IsRefusedInAFrameWithoutRasteriser) {
  EXPECT_EQ(complaint(tile_of_raster(), tiny_scope()), "kind of a node is out of range");
}

TEST(RasterCode, IsRefusedWithReferencesOutsideTheFrame) {
  const auto without = [](const std::function<void(RasterArraySizes&)>& change) {
    TileScope scope = tiny_raster();
    change(*scope.raster);
    return complaint(tile_of_raster(), scope);
  };
  EXPECT_EQ(without([](RasterArraySizes&) {}), "no error");
  EXPECT_EQ(without([](RasterArraySizes& d) { d.vertices = 8; }), "vertex of a triangle is out of range");
  EXPECT_EQ(without([](RasterArraySizes& d) { d.triangles = 4; }), "number of a triangle is out of range");
  EXPECT_EQ(without([](RasterArraySizes& d) { d.entries = 7; }), "a list of triangles is out of range");
}

TEST(RasterCode, IsRefusedWithContradictoryCounts) {
  const auto with = [](const std::function<void(TileWork&)>& change) {
    TileWork tile = tile_of_raster();
    change(tile);
    return complaint(tile, tiny_raster());
  };
  EXPECT_EQ(with([](TileWork& t) { t.raster_triangles[5].passed = 15; }), "coverage of a triangle is out of range");
  EXPECT_EQ(with([](TileWork& t) { t.raster_triangles[5].hidden_quads = 6; }),
            "coverage of a triangle is out of range");
  EXPECT_EQ(with([](TileWork& t) { t.raster_triangles[4].hidden_blocks = 4; }),
            "coverage of a triangle is out of range");
  EXPECT_EQ(with([](TileWork& t) { t.raster_triangles[0].lists = 3; }),
            "lists have not as many entries as triangles are in them");
  EXPECT_EQ(with([](TileWork& t) { t.list_runs[2].entries = 1; }),
            "lists have not as many entries as triangles are in them");
  EXPECT_EQ(with([](TileWork& t) { t.raster[1].pixel_samples = 0; }), "samples of a pixel is out of range");
  EXPECT_EQ(with([](TileWork& t) { t.nodes[2].items = 3; }),
            "rays without sources must be as many as the items that make them");
  EXPECT_EQ(with([](TileWork& t) { t.nodes[2].inputs[0].kind = Edge::Kind::kAll; }),
            "rays must have one input, an `each` edge from a launch");
  EXPECT_EQ(with([](TileWork& t) { t.nodes[3].inputs.resize(0); }), "no node reads the hits of node 2");
}

TEST(RasterCode, SurvivesAnyChangedByte) {
  const TileScope scope = tiny_raster();
  const std::string bytes = encode(tile_of_raster(), scope.links);
  TileWork back;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int change : {1, 0x40, 0x80, 0xff}) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ change);
      try {
        decode(changed, scope, back);
        for (const RasterTriangle& t : back.raster_triangles) {
          EXPECT_LT(t.number, scope.raster->triangles);
          for (const std::uint32_t vertex : t.vertices) EXPECT_LT(vertex, scope.raster->vertices);
        }
        for (const ListRun& run : back.list_runs) EXPECT_LE(run.first + run.entries, scope.raster->entries);
      } catch (const sim::InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace traces
