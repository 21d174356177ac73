#include "traces/accel/build.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <new>
#include <set>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "sim/error.h"
#include "tests/traces/accel/support.h"
#include "traces/accel/build/bvh_build.h"
#include "traces/accel/bvh_info.h"
#include "traces/walk.h"

namespace traces {
namespace {

/// Calls `leaf(link, node, child)` for every leaf and `inner(link, node, child)` for every inner child.
void for_each_child(const MemoryImage& image, auto&& inner, auto&& leaf) {
  for (std::uint32_t i = 0; i < image.nodes.size(); ++i) {
    for (int c = 0; c < 2; ++c) {
      const std::uint32_t link = image.nodes[i].child[c];
      if (link == kNoChild) continue;
      is_leaf(link) ? leaf(link, i, c) : inner(link, i, c);
    }
  }
}

double area(const NodeRecord& n, int c) {
  const double x = n.x[2 + c] - n.x[c], y = n.y[2 + c] - n.y[c], z = n.z[2 + c] - n.z[c];
  return x * y + y * z + z * x;
}

TEST(MemoryImage, IsTheSameForAnyNumberOfThreads) {
  for (const Scene& scene : {triangle_soup(20000, 0.05F), grid_soup(3000)}) {
    const MemoryImage one = build_memory_image(scene, {}, 1);
    for (const unsigned threads : {2U, 4U, 0U}) {
      const MemoryImage many = build_memory_image(scene, {}, threads);
      EXPECT_TRUE(same_bytes(one.nodes, many.nodes)) << threads;
      EXPECT_TRUE(same_bytes(one.triangles, many.triangles)) << threads;
    }
  }
}

TEST(MemoryImage, LeafTrianglesAreAPermutationOfTheInput) {
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.1F));
  std::set<std::uint32_t> sources;
  for (const TriangleRecord& t : image.triangles) sources.insert(t.source);
  EXPECT_EQ(sources.size(), 5000U);
  EXPECT_EQ(*sources.rbegin(), 4999U);

  std::vector<int> seen(5000, 0);
  for_each_child(
      image, [](auto...) {},
      [&](std::uint32_t link, std::uint32_t, int) {
        for (std::uint32_t i = 0; i < leaf_count(link); ++i) ++seen[leaf_first(link) + i];
      });
  EXPECT_EQ(std::ranges::count(seen, 1), 5000);
}

TEST(MemoryImage, BoxesHoldTheirTriangles) {
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.1F));
  for_each_child(
      image, [](auto...) {},
      [&](std::uint32_t link, std::uint32_t node, int c) {
        const NodeRecord& n = image.nodes[node];
        for (std::uint32_t i = 0; i < leaf_count(link); ++i) {
          const TriangleRecord& t = image.triangles[leaf_first(link) + i];
          for (const glm::vec3& v : {t.v0, t.v1, t.v2}) {
            EXPECT_TRUE(n.x[c] <= v.x && v.x <= n.x[2 + c]);
            EXPECT_TRUE(n.y[c] <= v.y && v.y <= n.y[2 + c]);
            EXPECT_TRUE(n.z[c] <= v.z && v.z <= n.z[2 + c]);
          }
        }
      });
}

TEST(MemoryImage, TheLargerChildIsChildZeroAndFollowsItsParent) {
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.1F));
  std::set<std::uint32_t> placed{0};
  for_each_child(
      image,
      [&](std::uint32_t link, std::uint32_t node, int c) {
        EXPECT_GT(link, node);
        EXPECT_TRUE(placed.insert(link).second) << "a node has two parents";
        if (c == 0 || is_leaf(image.nodes[node].child[0])) {
          EXPECT_EQ(link, node + 1);
        }
        EXPECT_GE(area(image.nodes[node], 0), area(image.nodes[node], 1));
      },
      [](auto...) {});
  EXPECT_EQ(placed.size(), image.nodes.size());
}

TEST(MemoryImage, NoLeafIsLargerThanConfigured) {
  for (const std::uint32_t leaf_size : {1U, 2U, 4U, 8U}) {
    const MemoryImage image = build_memory_image(grid_soup(2000), {.leaf_size = leaf_size});
    for_each_child(
        image, [](auto...) {}, [&](std::uint32_t link, std::uint32_t, int) { EXPECT_LE(leaf_count(link), leaf_size); });
  }
}

TEST(MemoryImage, ManyTrianglesInOnePlaceStillMakeATree) {
  Scene scene = one_triangle();
  scene.instances.resize(3000, scene.instances[0]);
  const MemoryImage image = build_memory_image(scene);
  EXPECT_EQ(image.triangles.size(), 3000U);
  EXPECT_LE(bvh_info(image).depth, BvhConfig{}.max_depth);
}

TEST(MemoryImage, RefusesATreeDeeperThanAllowed) {
  const Scene scene = triangle_soup(100000, 0.05F);
  EXPECT_LE(bvh_info(build_memory_image(scene, {.leaf_size = 1, .max_depth = 32})).depth, 32U);
  EXPECT_THROW(build_memory_image(scene, {.leaf_size = 1, .max_depth = 16}), sim::InputError);
}

TEST(MemoryImage, OneTriangleHangsBelowARootWithOneChild) {
  const MemoryImage image = build_memory_image(one_triangle());
  ASSERT_EQ(image.nodes.size(), 1U);
  EXPECT_EQ(image.nodes[0].child[0], leaf_link(0, 1));
  EXPECT_EQ(image.nodes[0].child[1], kNoChild);
  const BvhInfo info = bvh_info(image);
  EXPECT_EQ(info.nodes, 1U);
  EXPECT_EQ(info.leaves, 1U);
  EXPECT_EQ(info.depth, 1U);
  EXPECT_EQ(info.bytes, 64U + 48U);
  EXPECT_DOUBLE_EQ(info.sah_cost, 2);
}

TEST(MemoryImage, AnEmptySceneHasARootThatNothingHits) {
  const MemoryImage image = build_memory_image(Scene{});
  ASSERT_EQ(image.nodes.size(), 1U);
  EXPECT_EQ(bvh_info(image).leaves, 0U);
  EXPECT_EQ(image.diagonal(), 0);
}

TEST(MemoryImage, InstancesAreFlattenedWithTheirNormals) {
  Scene scene = one_triangle();
  scene.materials.resize(1);
  scene.instances.push_back({0, glm::scale(glm::translate(glm::mat4(1), {5, 0, 0}), {-2, 1, 1})});
  const MemoryImage image = build_memory_image(scene);
  ASSERT_EQ(image.triangles.size(), 2U);
  const auto mirrored = std::ranges::find(image.triangles, 1U, &TriangleRecord::object);
  ASSERT_NE(mirrored, image.triangles.end());
  EXPECT_EQ(mirrored->v1, glm::vec3(3, 0, 0));
  EXPECT_EQ(mirrored->source, 1U);
  for (const AttributeRecord& a : image.attributes) EXPECT_EQ(a.normal[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(image.upper, glm::vec3(5, 1, 0));
}

TEST(MemoryImage, GivenNormalsAreCarriedToWorldSpaceAtUnitLength) {
  Scene scene = one_triangle();
  scene.meshes[0].normals.assign(3, glm::vec3(1, 1, 0));
  scene.instances[0].to_world = glm::scale(glm::mat4(1), {2, 1, 1});
  const glm::vec3 n = build_memory_image(scene).attributes[0].normal[2];
  EXPECT_NEAR(n.x, 1 / std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(n.y, 2 / std::sqrt(5.0), 1e-6);
}

TEST(MemoryImage, PlacesEverythingOnLinesOfItsOwn) {
  Scene scene = triangle_soup(100, 0.3F);
  scene.textures.resize(2);
  scene.textures[0].width = 9, scene.textures[0].height = 5;
  scene.textures[1].width = scene.textures[1].height = 4;
  const MemoryImage image = build_memory_image(scene);
  const Layout& at = image.layout;
  for (const std::uint64_t base : {at.nodes, at.triangles, at.attributes, at.materials, at.textures[0].base,
                                   at.textures[1].base, at.frame_buffer, at.end}) {
    EXPECT_EQ(base % 64, 0U);
  }
  EXPECT_GE(at.triangles, at.node_at(static_cast<std::uint32_t>(image.nodes.size())));
  EXPECT_GE(at.attributes, at.triangle_at(100));
  EXPECT_GE(at.materials, at.attributes_at(100));
  EXPECT_GE(at.textures[0].base, at.material_at(1));
  EXPECT_EQ(at.textures[0].tiles_per_row, 3U);
  EXPECT_EQ(at.texel_tile_at(0, 8, 4), at.textures[0].base + 5 * 64);
  EXPECT_EQ(at.textures[1].base, at.textures[0].base + 6 * 64);
  EXPECT_EQ(at.end, at.textures[1].base + 64);
  EXPECT_EQ(at.frame_buffer, at.end);
}

TEST(MemoryImage, RecordsThatNoMaterialNeedsTakeNoMemory) {
  Scene scene = triangle_soup(100, 0.3F);
  scene.materials = {{.mirror = 0.5F}};
  const MemoryImage plain = build_memory_image(scene);
  EXPECT_EQ(plain.vertices.size() + plain.details.size() + plain.textures.size(), 0U);
  EXPECT_EQ(plain.layout.vertices, plain.layout.materials);
  EXPECT_EQ(plain.layout.details, plain.layout.end);

  scene.materials.push_back({.absorption = glm::vec3(1)});
  const MemoryImage absorbing = build_memory_image(scene);
  EXPECT_EQ(absorbing.details.size(), 2U);
  EXPECT_EQ(absorbing.layout.end, absorbing.layout.detail_at(2));
  EXPECT_TRUE(absorbing.vertices.empty());

  scene.meshes[0].colours.assign(300, glm::vec4(1));
  const MemoryImage coloured = build_memory_image(scene);
  EXPECT_EQ(coloured.vertices.size(), 100U);
  EXPECT_EQ(coloured.layout.materials, coloured.layout.vertices_at(100));

  scene.materials[0].alpha = Material::Alpha::kMask;
  const MemoryImage masked = build_memory_image(scene);
  ASSERT_EQ(masked.textures.size(), 1U);
  EXPECT_EQ(masked.white, 0U);
}

TEST(MemoryImage, FlagsMarkTrianglesThatAreNotOpaque) {
  const MemoryImage image = build_memory_image(with_transparent_triangles(triangle_soup(300, 0.3F)));
  for (const TriangleRecord& t : image.triangles) {
    const std::uint32_t material = t.material & kTriangleMask;
    EXPECT_EQ(t.hit_flags(), material == 0 ? 0 : material == 1 ? kAlphaFlag : kTintFlag);
  }
}

TEST(MemoryImage, VertexRecordsHoldColoursCoordinatesAndTangents) {
  Scene scene = one_triangle();
  Mesh& mesh = scene.meshes[0];
  mesh.uvs = {{1, 2}, {3, 4}, {5, 6}};
  mesh.colours = {{0, 1, 0.5F, 1}, {2, -1, 0, 1}, {1, 1, 1, 0}};
  mesh.tangents = {{2, 0, 0, 1}, {0, -3, 0, -1}, {0, 0, 0, 1}};
  scene.instances[0].to_world = glm::scale(glm::mat4(1), {-1, 1, 1});
  const VertexRecord v = build_memory_image(scene).vertices.at(0);
  EXPECT_EQ(v.uv[2], glm::vec2(5, 6)) << "the first coordinates, where there are no second";
  EXPECT_EQ(v.colour[0][0], 0xffff0000U);
  EXPECT_EQ(v.colour[0][1], 0xffff8000U);
  EXPECT_EQ(v.colour[1][0], 0x0000ffffU);
  EXPECT_EQ(v.tangent[0], 0x01808001U) << "mirrored, and so is the bitangent's sign";
  EXPECT_EQ(v.tangent[1], 0xff800180U);
  EXPECT_EQ(v.tangent[2] & 0xffffffU, 0x808080U);
}

TEST(MemoryImage, RefusesATextureThatIsNotThereOrEncodedForAnotherUse) {
  Scene scene = one_triangle();
  scene.textures.resize(1);
  scene.textures[0].width = scene.textures[0].height = 1;
  scene.textures[0].texels = {0};
  scene.materials = {{.name = "m", .base_texture = {1}}};
  EXPECT_THROW(build_memory_image(scene), sim::InputError);
  scene.materials = {{.name = "m", .normal_texture = {0}}};
  EXPECT_THROW(build_memory_image(scene), sim::InputError);
  scene.textures[0].srgb = false;
  EXPECT_NO_THROW(build_memory_image(scene));
  scene.materials = {{.name = "m", .emission_texture = {0}}};
  EXPECT_THROW(build_memory_image(scene), sim::InputError);
}

TEST(MemoryImage, TheHashCoversEveryBitOfTheTree) {
  MemoryImage image = build_memory_image(triangle_soup(100, 0.3F));
  const std::string hash = bvh_hash(image);
  EXPECT_EQ(hash, bvh_hash(build_memory_image(triangle_soup(100, 0.3F), {}, 1)));
  EXPECT_NE(hash, bvh_hash(build_memory_image(triangle_soup(100, 0.3F), {.leaf_size = 1})));
  image.triangles[50].object = 7;
  EXPECT_NE(hash, bvh_hash(image));
}

TEST(MemoryImage, RefusesAMeshWithInvalidReferences) {
  Scene scene = one_triangle();
  scene.meshes[0].triangles[0][2] = 3;
  EXPECT_THROW(build_memory_image(scene), sim::InputError);
  scene = one_triangle();
  scene.meshes[0].material = 1;
  EXPECT_THROW(build_memory_image(scene), sim::InputError);
  scene = one_triangle();
  scene.instances[0].mesh = 1;
  EXPECT_THROW(build_memory_image(scene), sim::InputError);
}

#ifndef RAYWATT_SANITIZED  // sanitizers would end the process
/// Limits the process to 8 MiB of additional memory after the first call.
bool limit_memory() {
  static const bool is_done = [] {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = pages * static_cast<rlim_t>(::getpagesize()) + (8U << 20);
    setrlimit(RLIMIT_AS, &limit);
    return true;
  }();
  return !is_done;
}

TEST(BvhBuilder, ThrowsBadAllocIfMemoryEndsDuringTheBuild) {
  for (const unsigned threads : {1U, 2U}) {
    EXPECT_EXIT(
        {
          const std::vector<Bounds> boxes(500'000, Bounds{{0, 0, 0}, {1, 1, 1}});
          try {
            BvhBuilder({}, threads, limit_memory).build_over(boxes);
          } catch (const std::bad_alloc&) {
            std::_Exit(74);
          }
          std::_Exit(0);
        },
        testing::ExitedWithCode(74), "");
  }
}
#endif

}  // namespace
}  // namespace traces
