#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"
#include "wide_walks.h"

// Hits and walks of wide trees of all formats, against those of the binary tree.

namespace traces {
namespace {

struct Form {
  std::uint32_t width = 2;
  NodeFormat format = NodeFormat::kFp32;
  Collapse collapse = Collapse::kArea;
  LeafFormat leaf = LeafFormat::kTriangles;

  BvhConfig config(InstanceLevels levels = InstanceLevels::kFlatten) const {
    return {.leaf_size = 3, .instances = levels, .width = width, .collapse = collapse, .format = format, .leaf = leaf};
  }
  std::string text() const {
    return std::to_string(width) + " " + std::string(names_of(format)[static_cast<std::size_t>(format)]) + " " +
           std::string(names_of(collapse)[static_cast<std::size_t>(collapse)]) + " " +
           std::string(names_of(leaf)[static_cast<std::size_t>(leaf)]);
  }
};

std::vector<Form> all_forms(bool hybrid) {
  std::vector<Form> forms;
  for (const std::uint32_t width : {2U, 4U, 6U, 8U}) {
    for (const NodeFormat format :
         {NodeFormat::kFp32, NodeFormat::kHybrid, NodeFormat::kQ8, NodeFormat::kQ12, NodeFormat::kCw80}) {
      for (const Collapse collapse : {Collapse::kArea, Collapse::kSah}) {
        for (const LeafFormat leaf : {LeafFormat::kTriangles, LeafFormat::kPair64, LeafFormat::kBlock128}) {
          if (leaf != LeafFormat::kTriangles && (width == 6 || collapse == Collapse::kArea)) continue;
          if (format == NodeFormat::kHybrid && !hybrid) continue;
          forms.push_back({width, format, collapse, leaf});
        }
      }
    }
  }
  return forms;
}

std::size_t expect_same_hits(const MemoryImage& expected_image, const MemoryImage& image,
                             const std::vector<Ray>& rays) {
  const std::vector<Hit> expected = trace(BvhTracer(expected_image), rays), found = trace(BvhTracer(image), rays);
  const std::vector<Hit> blocked = trace(BvhTracer(expected_image), rays, RayKind::kShadow);
  const std::vector<Hit> dark = trace(BvhTracer(image), rays, RayKind::kShadow);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(name_hit(image, found[i]), name_hit(expected_image, expected[i])) << i;
    EXPECT_EQ(dark[i].is_hit(), blocked[i].is_hit()) << i;
    // Whether an opaque triangle is found before the limit of a nearer flagged one depends on the order of visits.
    if (blocked[i].is_flagged() && dark[i].is_flagged()) {
      EXPECT_EQ(name_hit(image, dark[i]), name_hit(expected_image, blocked[i])) << i;
    }
    if (::testing::Test::HasFailure()) return 0;
    hits += expected[i].is_hit() ? 1 : 0;
  }
  return hits;
}

void expect_identities(const MemoryImage& image, const std::vector<Ray>& rays) {
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
    std::vector<Hit> hits;
    const WalkCounts c = count_walks(image, rays, kind, hits);
    EXPECT_EQ(c.hit_children, (c.visits - c.roots) + c.leaves + c.culled + c.dropped);
    EXPECT_EQ(c.pushes, c.pops + c.culled + c.dropped);
  }
}

TEST(WideWalk, FindsTheHitsOfTheBinaryTree) {
  for (const Scene& scene :
       {triangle_soup(2000, 0.15F), grid_soup(1000), with_transparent_triangles(triangle_soup(2000, 0.15F)),
        single_sided(sphere(24, 48)), one_triangle()}) {
    const MemoryImage binary = build_memory_image(scene);
    for (const Form& form : all_forms(true)) {
      SCOPED_TRACE(form.text());
      const MemoryImage image = build_memory_image(scene, form.config());
      EXPECT_GT(expect_same_hits(binary, image, random_rays(1500)), 2U);
      EXPECT_GT(expect_same_hits(binary, image, grid_rays(1500)), 2U);
      expect_identities(image, random_rays(500));
      EXPECT_EQ(count_different_in_portable(image, grid_rays(300)), 0U);
    }
  }
}

TEST(WideWalk, FindsTheHitsOfTheBinaryTreeInTwoLevels) {
  const Scene scene = scattered(60);
  const MemoryImage binary = build_memory_image(scene, {.instances = InstanceLevels::kTwoLevel});
  for (const Form& form : all_forms(false)) {
    SCOPED_TRACE(form.text());
    const MemoryImage image = build_memory_image(scene, form.config(InstanceLevels::kTwoLevel));
    EXPECT_GT(expect_same_hits(binary, image, random_rays(5000)), 100U);
    expect_identities(image, random_rays(1000));
  }
}

TEST(WideWalk, FindsTheHitsOfTheBinaryTreeInAnyOrderOfVisits) {
  for (const Scene& scene : {triangle_soup(2000, 0.15F), grid_soup(1000)}) {
    const MemoryImage binary = build_memory_image(scene);
    const std::vector<Ray> rays = random_rays(5000);
    std::vector<Hit> hits;
    std::map<ChildOrder, std::uint64_t> visits;
    for (const ChildOrder order : {ChildOrder::kSort, ChildOrder::kNearest, ChildOrder::kOctant}) {
      BvhConfig config = Form{8, NodeFormat::kCw80}.config();
      config.order = order;
      const MemoryImage image = build_memory_image(scene, config);
      expect_same_hits(binary, image, rays);
      expect_same_hits(binary, image, grid_rays(3000));
      expect_identities(image, rays);
      visits[order] = count_walks(image, rays, RayKind::kPrimary, hits).visits;
    }
    EXPECT_LT(visits[ChildOrder::kSort], visits[ChildOrder::kNearest]);
    EXPECT_LT(visits[ChildOrder::kNearest], 1.2 * static_cast<double>(visits[ChildOrder::kSort]));
    EXPECT_LT(visits[ChildOrder::kOctant], 1.3 * static_cast<double>(visits[ChildOrder::kSort]))
        << "with slots that do not suit the octant far more";
  }
}

TEST(WideWalk, FindsNothingInAnEmptyScene) {
  for (const Form& form : all_forms(true)) {
    SCOPED_TRACE(form.text());
    const MemoryImage image = build_memory_image(Scene{}, form.config());
    for (const Hit& hit : trace(BvhTracer(image), random_rays(100))) EXPECT_FALSE(hit.is_hit());
  }
}

TEST(WideWalk, AgreesWithEmbree) {
  const Scene scene = triangle_soup(5000, 0.2F);
  for (const NodeFormat format : {NodeFormat::kFp32, NodeFormat::kQ8, NodeFormat::kQ12, NodeFormat::kCw80}) {
    const MemoryImage image = build_memory_image(scene, Form{8, format}.config());
    const BvhTracer bvh(image);
    const EmbreeTracer embree(image, 1);
    const VerifyingTracer verifying(image, bvh, embree);
    trace(verifying, random_rays(20000));
    trace(verifying, random_rays(20000, 9), RayKind::kShadow);
    EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
  }
}

TEST(WideTree, HasFewerVisitsTheWiderItIs) {
  const Scene scene = triangle_soup(5000, 0.05F);
  const std::vector<Ray> rays = random_rays(5000);
  std::vector<Hit> hits;
  std::uint64_t before = count_walks(build_memory_image(scene), rays, RayKind::kPrimary, hits).visits;
  for (const std::uint32_t width : {4U, 6U, 8U}) {
    const std::uint64_t visits =
        count_walks(build_memory_image(scene, {.width = width}), rays, RayKind::kPrimary, hits).visits;
    EXPECT_LT(visits, before);
    before = visits;
  }
}

TEST(WideTree, IsCheaperAndFullerByTheDynamicProgramme) {
  const Scene scene = triangle_soup(5000, 0.05F);
  for (const std::uint32_t width : {4U, 6U, 8U}) {
    const BvhInfo area = bvh_info(build_memory_image(scene, {.width = width}));
    const BvhInfo sah = bvh_info(build_memory_image(scene, {.width = width, .collapse = Collapse::kSah}));
    EXPECT_LE(sah.sah_cost, area.sah_cost * 1.000001);
    EXPECT_GT(sah.occupancy(), 0.4);
    const BvhInfo bytes = bvh_info(
        build_memory_image(scene, {.width = width, .collapse = Collapse::kSah, .collapse_cost = CollapseCost::kBytes}));
    EXPECT_GE(bytes.sah_cost, sah.sah_cost * 0.999999);
  }
}

TEST(WideTree, KeepsItsShapeInARefitAndFindsTheHitsOfARebuild) {
  const Scene scene = triangle_soup(2000, 0.15F);
  Scene moved = scene;
  Dice dice(5);
  for (glm::vec3& p : moved.meshes[0].positions) p += 0.1F * dice.point();
  for (const Form& form : all_forms(true)) {
    SCOPED_TRACE(form.text());
    BvhConfig config = form.config();
    config.update = BvhUpdate::kRefit;
    MemoryImage image = build_memory_image(scene, config);
    const auto links = [&] {
      std::vector<std::uint32_t> all;
      for (std::uint32_t i = 0; i < image.node_count(); ++i) {
        all.insert(all.end(), image.links_of(i).begin(), image.links_of(i).end());
      }
      return all;
    };
    const std::vector<std::uint32_t> before = links();
    update_memory_image(moved, config, 1, image);
    EXPECT_EQ(links(), before);
    EXPECT_GT(expect_same_hits(build_memory_image(moved), image, random_rays(3000)), 100U);
  }
}

/// Returns a mesh that deforms and six instances of a sphere.
Scene deforming_scene() {
  Scene scene = triangle_soup(500, 0.2F);
  scene.meshes[0].deformation = std::make_shared<Deformation>();
  scene.meshes.push_back(sphere(8, 12).meshes[0]);
  for (std::uint32_t i = 0; i < 6; ++i) {
    Instance& instance = scene.instances.emplace_back();
    instance.mesh = 1;
    for (int a = 0; a < 3; ++a) instance.to_world[a] *= 0.3F;
    instance.to_world[3] = glm::vec4(static_cast<float>(i) * 0.3F - 1, 0.2F, 0.1F * static_cast<float>(i), 1);
  }
  return scene;
}

TEST(WideTree, FollowsInstancesAndDeformingMeshesInTwoLevels) {
  const Scene scene = deforming_scene();
  Scene moved = scene;
  Dice dice(6);
  for (glm::vec3& p : moved.meshes[0].positions) p += 0.1F * dice.point();
  for (Instance& instance : moved.instances) instance.to_world[3] += glm::vec4(0.2F * dice.point(), 0);
  const MemoryImage expected = build_memory_image(moved, {.instances = InstanceLevels::kTwoLevel});
  for (const Form& form : all_forms(false)) {
    for (const BvhUpdate update : {BvhUpdate::kRebuild, BvhUpdate::kRefit}) {
      SCOPED_TRACE(form.text());
      BvhConfig config = form.config(InstanceLevels::kTwoLevel);
      config.update = update;
      MemoryImage image = build_memory_image(scene, config);
      for (int step = 0; step < 2; ++step) {
        update_memory_image(step == 0 ? scene : moved, config, 1, image);
        EXPECT_GT(
            expect_same_hits(step == 0 ? build_memory_image(scene, {.instances = InstanceLevels::kTwoLevel}) : expected,
                             image, random_rays(1500)),
            100U);
      }
    }
  }
}

TEST(WideTree, HasRecordsAtDifferentPlacesWithinItsArrays) {
  for (const Scene& scene : {triangle_soup(300, 0.2F), scattered(40)}) {
    for (const bool two : {false, true}) {
      for (const Form& form : all_forms(false)) {
        if (form.width == 2 && form.format == NodeFormat::kFp32) continue;
        SCOPED_TRACE(form.text());
        const MemoryImage image =
            build_memory_image(scene, form.config(two ? InstanceLevels::kTwoLevel : InstanceLevels::kFlatten));
        const Layout& at = image.layout;
        std::map<std::uint64_t, std::uint64_t> ends;  // of all records, by their beginnings
        const auto add = [&](std::uint64_t begin, std::uint64_t bytes) { ends.emplace(begin, begin + bytes); };
        for (std::uint32_t i = 0; i < image.node_count(); ++i) add(at.node_at(i), at.node_bytes);
        for (std::uint32_t i = 0; i < image.instances.size(); ++i) add(at.instance_at(i), sizeof(InstanceRecord));
        std::size_t records = image.node_count() + image.instances.size();
        for (std::uint32_t i = 0; i < image.triangles.size(); ++i) {
          add(at.triangle_at(i), at.triangle_bytes);
          records += image.begins_record.empty() || image.begins_record[i] ? 1 : 0;
        }
        EXPECT_EQ(ends.size(), records) << "one place for each record";
        std::uint64_t before = 0;
        for (const auto& [begin, end] : ends) {
          ASSERT_GE(begin, before);
          before = end;
        }
        EXPECT_LE(before, at.has_labels() ? at.labels : at.attributes);
        EXPECT_LE(at.leaf_bytes + image.node_array_bytes(), at.tree_bytes);
        if (form.format != NodeFormat::kQ8) {
          EXPECT_EQ(at.tree_bytes, image.node_count() * at.node_bytes +
                                       image.instances.size() * sizeof(InstanceRecord) + at.leaf_bytes)
              << "records x size";
        }
      }
    }
  }
}

TEST(WideTree, HasConsecutiveInnerChildrenAndLeaves) {
  for (const Form& form : all_forms(true)) {
    if (form.width == 2 && !is_quantised(form.format)) continue;
    SCOPED_TRACE(form.text());
    const MemoryImage image = build_memory_image(triangle_soup(1000, 0.2F), form.config());
    std::vector<int> parents(image.node_count(), 0), leaves(image.triangles.size(), 0);
    for (std::uint32_t i = 0; i < image.node_count(); ++i) {
      std::uint32_t inner = kNone, triangle = kNone, children = 0;
      for (const std::uint32_t link : image.links_of(i)) {
        if (link == kNoChild) continue;
        ++children;
        if (is_leaf(link)) {
          EXPECT_TRUE(triangle == kNone || leaf_first(link) == triangle);
          triangle = leaf_first(link) + leaf_count(link);
          for (std::uint32_t t = leaf_first(link); t < triangle; ++t) ++leaves.at(t);
        } else {
          EXPECT_GT(link, i);
          EXPECT_TRUE(inner == kNone || link == inner);
          inner = link + 1;
          ++parents.at(link);
        }
      }
      EXPECT_GE(children, 2U);
      EXPECT_LE(children, form.width);
    }
    EXPECT_EQ(std::ranges::count(parents, 1), static_cast<std::ptrdiff_t>(parents.size()) - 1) << "all but the root";
    EXPECT_EQ(std::ranges::count(leaves, 1), static_cast<std::ptrdiff_t>(leaves.size()));
  }
}

}  // namespace
}  // namespace traces
