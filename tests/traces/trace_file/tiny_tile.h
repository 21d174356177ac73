#pragma once
#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "traces/trace_file/tile_code.h"
#include "traces/walk.h"

namespace traces::test {

// A tree of three inner nodes and four leaves, and a tile with everything that a tile may contain.
//
//          0
//      1       2
//    t0 t1-3 t4 t5-6

inline TileScope tiny_scope() {
  return {
      {.nodes = {{1, 2}, {leaf_link(0, 1), leaf_link(1, 3)}, {leaf_link(4, 1), leaf_link(5, 2)}}, .roots = {}},
      {.triangles = 7, .attributes = 7, .vertices = 7, .materials = 2, .details = 2, .textures = {{64, 32}, {8, 8}}},
      5,
      {4096, 512, 16}};
}

inline TileWork tiny_tile() {
  using enum WorkNode::Kind;
  TileWork t;
  t.frame = 3;
  t.tile = 12;
  t.samples = 4;
  t.imports = {{11, 3}};
  t.after_all = true;
  t.nodes = {
      {.kind = kTransfer,
       .items = 16,
       .region = Region::kRates,
       .to_memory = false,
       .offset = 0,
       .border = 0,
       .inputs = {}},
      {.kind = kLaunch, .kernel = 4, .items = 3, .idle = 2, .inputs = {{0, Edge::Kind::kAll}}},
      {.kind = kRays, .ray_kind = RayKind::kPrimary, .items = 3, .first = 0, .inputs = {{1, Edge::Kind::kEach}}},
      {.kind = kLaunch, .kernel = 0, .items = 3, .first = 0, .has_accesses = true, .inputs = {{2, Edge::Kind::kEach}}},
      {.kind = kRays,
       .ray_kind = RayKind::kShadow,
       .items = 2,
       .first = 3,
       .sources = 0,
       .inputs = {{3, Edge::Kind::kEach}}},
      {.kind = kLaunch,
       .kernel = 1,
       .items = 1,
       .first = 3,
       .has_accesses = true,
       .inputs = {{4, Edge::Kind::kAll}, {2, Edge::Kind::kAll}}},
      {.kind = kTransfer, .items = 256, .offset = 3840, .border = 7, .inputs = {{5, Edge::Kind::kAll}}},
  };
  t.sources = {0, 2};
  t.accesses = {Access::attributes(6),
                Access::material(1),
                Access::texels(0, 63, 31, 0, 0),
                Access::attributes(2),
                Access::of_kind(Access::Kind::kVertices, 2),
                Access::texels(1, 7, 3, 7, 4),
                Access::texels(0, 1, 2, 2, 3),
                Access::of_kind(Access::Kind::kTriangle, 6),
                Access::of_kind(Access::Kind::kDetail, 1)};
  t.access_begin = {0, 3, 3, 7, 9};
  const auto ray = [&](std::initializer_list<std::uint32_t> words) {
    t.ray_begin.push_back(static_cast<std::uint32_t>(t.walk.size()));
    t.walk.insert(t.walk.end(), words);
  };
  ray({visit_step(0, 0, 0), end_step(false)});
  ray({visit_step(0, 3, 1), visit_step(2, 3, 0), leaf_step(4, 1), 0x3, cull_step(2), end_step(true)});
  ray({visit_step(0, 3, 0), visit_step(1, 3, 1), leaf_step(1, 3), 0x212, leaf_step(0, 1), 0x2, visit_step(2, 2, 0),
       leaf_step(5, 2), 0x31, end_step(true)});
  ray({visit_step(0, 3, 0), visit_step(1, 3, 0), leaf_step(0, 1), 0x3, cull_step(1), visit_step(2, 0, 0),
       end_step(true)});
  ray({visit_step(0, 3, 0), visit_step(1, 2, 0), leaf_step(1, 2), 0x31, end_step(true)});
  return t;
}

// A tree of two levels, and a tile of rays through it.
//
//          0                      over instances
//     i2       1
//           i0   i1               i3 has no triangles
//
//     2 (i0, i2)      4 (i1)
//   t0   3          t4-5
//     t1-2 t3

inline TileScope tiny_levels() {
  return {{.nodes = {{instance_link(2), 1},
                     {instance_link(0), instance_link(1)},
                     {leaf_link(0, 1), 3},
                     {leaf_link(1, 2), leaf_link(3, 1)},
                     {leaf_link(4, 2), kNoChild}},
           .roots = {2, 4, 2, kNone}},
          {.triangles = 6, .attributes = 6, .materials = 1, .textures = {}, .instances = 4, .trees = 2},
          2,
          {4096, 512, 16}};
}

inline TileWork tile_of_levels() {
  using enum WorkNode::Kind;
  TileWork t;
  t.nodes = {{.kind = kLaunch, .kernel = 0, .items = 3, .inputs = {}},
             {.kind = kRays, .items = 3, .first = 0, .inputs = {{0, Edge::Kind::kEach}}},
             {.kind = kLaunch, .kernel = 1, .items = 3, .has_accesses = true, .inputs = {{1, Edge::Kind::kEach}}}};
  t.accesses = {Access::attributes(4), Access::of_kind(Access::Kind::kInstance, 1), Access::attributes(0),
                Access::of_kind(Access::Kind::kInstance, 0)};
  t.access_begin = {0, 2, 4, 4};
  const auto ray = [&](std::initializer_list<std::uint32_t> words) {
    t.ray_begin.push_back(static_cast<std::uint32_t>(t.walk.size()));
    t.walk.insert(t.walk.end(), words);
  };
  ray({visit_step(0, 3, 0), instance_step(2), visit_step(2, 2, 0), visit_step(3, 3, 1), leaf_step(3, 1), 0x2,
       leaf_step(1, 2), 0x31, visit_step(1, 2, 0), instance_step(1), visit_step(4, 1, 0), leaf_step(4, 2), 0x12,
       end_step(true)});
  ray({visit_step(0, 3, 1), visit_step(1, 3, 0), instance_step(0), visit_step(2, 3, 0), leaf_step(0, 1), 0x3,
       cull_step(2), instance_step(2), visit_step(2, 0, 0), end_step(true)});
  ray({visit_step(0, 1, 0), instance_step(2), visit_step(2, 0, 0), end_step(false)});
  return t;
}

// A batch of triangles and a wave of samples for a rasteriser. The frame has 9 vertices, 5 triangles, 8 list entries.

inline TileScope tiny_raster() {
  TileScope scope = tiny_scope();
  scope.raster = RasterArraySizes{9, 5, 8};
  return scope;
}

inline TileWork tile_of_raster() {
  using enum WorkNode::Kind;
  TileWork t;
  t.nodes = {{.kind = kBin, .items = 3, .raster = 0, .inputs = {}},
             {.kind = kLaunch, .kernel = 0, .items = 4, .inputs = {}},
             {.kind = kRaster, .items = 4, .raster = 1, .inputs = {{1, Edge::Kind::kEach}}},
             {.kind = kLaunch, .kernel = 1, .items = 4, .inputs = {{2, Edge::Kind::kEach}, {0, Edge::Kind::kAll}}}};
  t.access_begin = {0};
  t.raster = {{0, 3, 0, 2, 1}, {3, 3, 2, 2, 4}};
  t.list_runs = {{0, 1}, {4, 2}, {6, 2}, {1, 1}};
  t.raster_triangles = {{.number = 0, .vertices = {0, 1, 2}, .lists = 2},
                        {.number = 1, .vertices = {2, 1, 8}},
                        {.number = 2, .vertices = {8, 3, 0}, .lists = 1},
                        {.number = 4, .vertices = {8, 7, 6}},
                        {.number = 0, .vertices = {0, 1, 2}, .blocks = 3, .hidden_blocks = 2},
                        {.number = 1,
                         .vertices = {2, 1, 8},
                         .blocks = 9,
                         .hidden_blocks = 1,
                         .quads = 5,
                         .hidden_quads = 2,
                         .samples = 17,
                         .hidden_samples = 3,
                         .passed = 14}};
  return t;
}

// A tree over four triangles with five vertices for a tree builder.

inline TileScope tiny_build() {
  TileScope scope = tiny_scope();
  scope.build = BuildArraySizes{.vertices = 6, .triangles = 7, .instances = 2};
  return scope;
}

inline TileWork tile_of_build() {
  TileWork t;
  t.nodes = {{.kind = WorkNode::Kind::kBuild, .items = 4, .first = 0, .inputs = {}}};
  t.access_begin = {0};
  t.build = {{.refit = true, .first_item = 3, .output = {{{64, 192}, {320, 192}, {4096, 48}}}, .comparisons = 77}};
  t.build_triangles = {{0, 1, 2}, {2, 1, 3}, {3, 4, 5}, {0, 2, 4}};
  t.build_order = {2, 0, 3, 1};
  return t;
}

inline bool same(const WorkNode& a, const WorkNode& b) {
  const auto edges = [](const Edge& x, const Edge& y) { return x.node == y.node && x.kind == y.kind; };
  return a.kind == b.kind && a.ray_kind == b.ray_kind && a.kernel == b.kernel && a.items == b.items &&
         a.first == b.first && a.has_accesses == b.has_accesses && a.idle == b.idle && a.region == b.region &&
         a.to_memory == b.to_memory && a.offset == b.offset && a.border == b.border && a.sources == b.sources &&
         a.raster == b.raster && std::ranges::equal(a.inputs, b.inputs, edges);
}

inline bool same(const TileWork& a, const TileWork& b) {
  const auto accesses = [](const Access& x, const Access& y) {
    return x.object == y.object && x.element == y.element && x.element2 == y.element2;
  };
  const auto jobs = [](const RasterWork& x, const RasterWork& y) {
    return x.first_triangle == y.first_triangle && x.triangles == y.triangles && x.first_run == y.first_run &&
           x.runs == y.runs && x.pixel_samples == y.pixel_samples;
  };
  return a.frame == b.frame && a.tile == b.tile && a.samples == b.samples && a.imports == b.imports &&
         a.after_all == b.after_all && a.walk == b.walk && a.ray_begin == b.ray_begin &&
         a.access_begin == b.access_begin && a.sources == b.sources &&
         std::ranges::equal(a.accesses, b.accesses, accesses) && std::ranges::equal(a.raster, b.raster, jobs) &&
         a.raster_triangles == b.raster_triangles && a.list_runs == b.list_runs && a.build == b.build &&
         a.build_triangles == b.build_triangles && a.build_order == b.build_order &&
         std::ranges::equal(a.nodes, b.nodes, [](const WorkNode& x, const WorkNode& y) { return same(x, y); });
}

/// Returns the bytes with the padding after the data that decoders may read.
inline std::string padded(std::string bytes) { return bytes.append(16, '\x5a'); }

inline TileRays decode(const std::string& bytes, const TileScope& scope, TileWork& work) {
  const std::string with_padding = padded(bytes);
  return TileDecoder().decode_tile(std::string_view(with_padding).substr(0, bytes.size()), scope, work);
}

inline std::string encode(const TileWork& work, const Links& links) {
  std::string bytes;
  TileEncoder().encode_tile(work, links, bytes);
  return bytes;
}

/// Encodes and decodes a tile and returns the error message, or "no error".
inline std::string complaint(const TileWork& tile, const TileScope& scope) {
  TileWork back;
  try {
    decode(encode(tile, tiny_scope().links), scope, back);
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace traces::test
