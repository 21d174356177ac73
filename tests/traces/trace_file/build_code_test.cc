#include <functional>

#include <gtest/gtest.h>

#include "tests/traces/trace_file/tiny_tile.h"

// Tests of encoding a tree builder's work.

namespace traces {
namespace {

using test::complaint;
using test::decode;
using test::encode;
using test::same;
using test::tile_of_build;
using test::tiny_build;
using test::tiny_scope;

TEST(BuildCode, RestoresATree) {
  const TileScope scope = tiny_build();
  TileWork back;
  for (const BuildWork::Input input : {BuildWork::Input::kTriangles, BuildWork::Input::kInstances}) {
    TileWork tile = tile_of_build();
    if (input == BuildWork::Input::kInstances) {
      tile.build[0].input = input;
      tile.build[0].first_item = 0;
      tile.nodes[0].items = 2;
      tile.build_triangles.clear();
      tile.build_order.clear();
    }
    decode(encode(tile, scope.links), scope, back);
    EXPECT_TRUE(same(tile, back));
  }
}

TEST(BuildCode, IsRefusedInAFrameWithoutBuilder) {
  EXPECT_EQ(complaint(tile_of_build(), tiny_scope()), "kind of a node is out of range");
}

TEST(BuildCode, IsRefusedWithReferencesOutsideTheFrame) {
  const auto without = [](const std::function<void(BuildArraySizes&)>& change) {
    TileScope scope = tiny_build();
    change(*scope.build);
    return complaint(tile_of_build(), scope);
  };
  EXPECT_EQ(without([](BuildArraySizes&) {}), "no error");
  EXPECT_EQ(without([](BuildArraySizes& d) { d.vertices = 5; }), "vertex of a triangle is out of range");
  EXPECT_EQ(without([](BuildArraySizes& d) { d.triangles = 6; }), "the building of a tree is out of range");
  TileWork tile = tile_of_build();
  tile.build_order[1] = 4;
  EXPECT_EQ(complaint(tile, tiny_build()), "number of a triangle is out of range");
  tile = tile_of_build();
  tile.nodes.push_back({.kind = WorkNode::Kind::kLaunch, .kernel = 0, .items = 1, .inputs = {}});
  EXPECT_EQ(complaint(tile, tiny_build()), "number of nodes is out of range");
}

}  // namespace
}  // namespace traces
