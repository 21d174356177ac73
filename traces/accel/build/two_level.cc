#include "traces/accel/build/two_level.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "sim/error.h"
#include "traces/accel/build.h"
#include "traces/accel/build/bvh_build.h"
#include "traces/accel/build/collapse.h"
#include "traces/accel/build/flatten.h"
#include "traces/accel/leaf_format.h"
#include "traces/accel/wide_format.h"
#include "traces/scene/bounds.h"

namespace traces {
namespace {

/// Limits up to which the matrix of an instance counts as invertible: the growth of errors (Placement::growth), and the
/// size of the inverse's entries. The size limits keep products of two squared entries within single precision in
/// kernels.
constexpr double kMostGrowth = 256, kLargestEntry = 0x1p16, kSmallestEntry = 0x1p-16;
/// Padding of instance boxes, in machine epsilons; see pad_box().
constexpr float kPadding = 64;

/// The record of an instance, and by how much its transform enlarges rounding errors.
struct Placement {
  InstanceRecord record{};
  /// Factor by which rounding errors grow between the world and the mesh's space: the largest row sum of |to_world|
  /// |to_object|. The factor is 1 for a scaling along axes and at most 3 for a rotation.
  float growth = 1;
};

/// Inverts the matrix of an instance into `out`. Returns false if there is no sufficiently accurate inverse.
bool invert_matrix(const glm::mat4& to_world, Placement& out) {
  const glm::dmat3 linear{glm::dmat4(to_world)};
  const double determinant = glm::determinant(linear);
  if (determinant == 0 || !std::isfinite(determinant)) return false;
  const glm::dmat3 inverse = glm::inverse(linear);
  const glm::dvec3 translation = -(inverse * glm::dvec3(to_world[3]));
  double growth = 0, largest = 0;
  for (int row = 0; row < 3; ++row) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      largest = std::max(largest, std::abs(inverse[k][row]));
      for (int column = 0; column < 3; ++column) sum += std::abs(linear[k][row]) * std::abs(inverse[column][k]);
    }
    growth = std::max(growth, sum);
  }
  if (!(growth <= kMostGrowth && largest <= kLargestEntry && largest >= kSmallestEntry)) return false;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double entry = column < 3 ? inverse[column][row] : translation[row];
      out.record.to_object[row][column] = static_cast<float>(entry);
    }
  }
  out.record.handedness = determinant < 0 ? -1.0F : 1.0F;
  out.record.volume = static_cast<float>(std::abs(determinant));
  out.growth = static_cast<float>(growth);
  return true;
}

Placement identity_placement() {
  Placement p;
  for (int i = 0; i < 3; ++i) p.record.to_object[i][i] = 1;
  p.record.handedness = p.record.volume = 1;
  return p;
}

/// The BVHs (trees) of a two-level image, and which tree each instance uses. Root nodes are set later.
struct TreePlan {
  explicit TreePlan(const Scene& scene);
  bool matches_image(const MemoryImage& image) const;

  std::vector<ObjectTree> trees;
  std::vector<std::uint32_t> tree_of;
  std::vector<Placement> placements;
  std::size_t triangles = 0;
};

TreePlan::TreePlan(const Scene& scene) : tree_of(scene.instances.size(), kNone) {
  if (scene.instances.size() > kMaxInstances) {
    throw sim::InputError("the scene has " + std::to_string(scene.instances.size()) + " instances; at most " +
                          std::to_string(kMaxInstances) + " are allowed with bvh.instances: two_level");
  }
  std::vector<std::uint32_t> shared(scene.meshes.size(), kNone);
  std::vector<std::pair<std::uint32_t, ObjectTree>> own;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    Placement& placement = placements.emplace_back(identity_placement());
    const bool invertible = invert_matrix(instance.to_world, placement);
    if (!invertible) placement = identity_placement();
    placement.record.object = object_id_of(instance, i);
    if (mesh.triangles.empty()) continue;
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    if (invertible && mesh.deformation == nullptr) {
      if (shared[instance.mesh] == kNone) {
        shared[instance.mesh] = static_cast<std::uint32_t>(trees.size());
        trees.push_back({.mesh = instance.mesh, .triangles = count});
      }
      tree_of[i] = shared[instance.mesh];
    } else {
      own.emplace_back(i, ObjectTree{.mesh = instance.mesh, .only = i, .in_world = !invertible, .triangles = count});
    }
  }
  for (const auto& [instance, tree] : own) {
    tree_of[instance] = static_cast<std::uint32_t>(trees.size());
    trees.push_back(tree);
  }
  for (ObjectTree& tree : trees) {
    tree.first_triangle = static_cast<std::uint32_t>(triangles);
    triangles += tree.triangles;
  }
}

bool TreePlan::matches_image(const MemoryImage& image) const {
  const auto alike = [](const ObjectTree& a, const ObjectTree& b) {
    return a.mesh == b.mesh && a.only == b.only && a.in_world == b.in_world && a.triangles == b.triangles;
  };
  return tree_of == image.tree_of && std::ranges::equal(trees, image.trees, alike);
}

PlacedMesh placed_mesh_of(const Scene& scene, const ObjectTree& tree) {
  return {&scene.meshes[tree.mesh], tree.in_world ? scene.instances[tree.only].to_world : glm::mat4(1)};
}

/// Returns the section of an array with one record per triangle that belongs to one tree.
template <class Record>
std::span<Record> tree_records(std::vector<Record>& records, const ObjectTree& tree) {
  return std::span(records).subspan(tree.first_triangle, tree.triangles);
}

/// Copies the shading records of a tree's triangles from mesh order into the image, in leaf order.
void store_shading(const ShadingRecords& shading, const ObjectTree& tree, MemoryImage& image) {
  for (std::uint32_t i = tree.first_triangle; i < tree.first_triangle + tree.triangles; ++i) {
    const std::uint32_t source = image.triangles[i].source;
    image.attributes[i] = shading.attributes[source];
    if (!shading.vertices.empty()) image.vertices[i] = shading.vertices[source];
  }
}

/// Appends the nodes of a tree and moves their links to the places of the tree's nodes and triangles.
template <class Node>
void append_nodes(const std::vector<Node>& nodes, const ObjectTree& tree, std::vector<Node>& all) {
  for (Node node : nodes) {
    for (std::uint32_t& link : node.child) {
      if (link != kNoChild) link += is_leaf(link) ? tree.first_triangle : tree.first_node;
    }
    all.push_back(node);
  }
}

/// Builds the tree of a mesh, appends its nodes to the image and sorts its triangles into leaf order.
void add_tree(const BvhBuilder& builder, const BvhConfig& config, ObjectTree& tree, MemoryImage& image) {
  const std::span<TriangleRecord> triangles = tree_records(image.triangles, tree);
  FlatBvh bvh = builder.build_over(std::span<const TriangleRecord>(triangles));
  image.build_statistics[1 + static_cast<std::size_t>(&tree - image.trees.data())] = std::move(bvh.statistics);
  tree.first_node = static_cast<std::uint32_t>(image.node_count());
  if (config.is_wide()) {
    WideBvh wide = collapse_tree(bvh, config, max_triangles_of_merged_leaf(config));
    bvh.order = std::move(wide.order);
    if (is_quantised(image.wide_format)) quantise_nodes(wide.nodes, image.wide_format);
    append_nodes(wide.nodes, tree, image.wide_nodes);
  } else {
    append_nodes(bvh.nodes, tree, image.nodes);
  }
  if (image.leaf_format != LeafFormat::kTriangles) {
    arrange_leaves(triangles, triangle_leaves(image, tree.first_node), image.leaf_format, bvh.order,
                   image.begins_record, tree.first_triangle);
  }
  reorder_records(triangles, bvh.order);
}

/// Returns an instance's box, enlarged so that no ray misses it through rounding.
///
/// A ray is tested in the mesh's space, and the transform's rounding errors do not follow from the box in world space.
/// Let o be the ray's origin, c the mesh's origin and g the growth of errors: the error is about 4 g (2 |o| + |c| +
/// size) epsilons. The padding covers it for rays that begin within eight scene sizes. For rays from farther away,
/// errors of the triangle test are of the same order, and RayBoxes grows its boxes accordingly.
Bounds pad_box(Bounds box, const Placement& placement, const glm::mat4& to_world, const Bounds& scene) {
  float far = scene.diagonal();
  float centre = 0;
  for (int a = 0; a < 3; ++a) {
    far = std::max({far, std::abs(scene.lower[a]), std::abs(scene.upper[a])});
    centre = std::max(centre, std::abs(to_world[3][a]));
  }
  const float pad = kPadding * std::numeric_limits<float>::epsilon() * placement.growth * (far + centre);
  box.lower -= pad;
  box.upper += pad;
  return box;
}

/// Makes the leaves of the tree over instances name the instances.
template <class Node>
void name_instances(std::vector<Node>& top, const std::vector<std::uint32_t>& order,
                    const std::vector<std::uint32_t>& shown) {
  for (Node& node : top) {
    for (std::uint32_t& link : node.child) {
      if (is_leaf(link)) link = instance_link(shown[order[leaf_first(link)]]);
    }
  }
}

/// Replaces the wide tree over instances, and moves the trees below it to the nodes after it.
void replace_top(const std::vector<WideNode>& top, MemoryImage& image) {
  std::vector<WideNode>& nodes = image.wide_nodes;
  const std::size_t before = image.trees.empty() ? nodes.size() : image.trees.front().first_node;
  const auto moved =
      static_cast<std::uint32_t>(top.size() - before);  // `top` may be smaller: links are added modulo 2^32
  nodes.erase(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(before));
  for (WideNode& node : nodes) {
    for (std::uint32_t& link : node.child) {
      if (!is_leaf(link) && link != kNoChild) link += moved;
    }
  }
  nodes.insert(nodes.begin(), top.begin(), top.end());
  for (ObjectTree& tree : image.trees) tree.first_node += moved;
  for (std::size_t i = 0; i < image.instances.size(); ++i) {
    if (image.tree_of[i] != kNone) image.instances[i].root = image.trees[image.tree_of[i]].first_node;
  }
}

/// Fills the instance records, the tree over instances and the scene's bounds. The tree takes the first nodes of the
/// image; those of a binary tree are already allocated.
void place_instances(const Scene& scene, const TreePlan& plan, const BvhBuilder& builder, const BvhConfig& config,
                     MemoryImage& image) {
  std::vector<Bounds> boxes;
  std::vector<std::uint32_t> shown;
  Bounds all;
  image.instances.clear();
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    InstanceRecord& record = image.instances.emplace_back(plan.placements[i].record);
    if (plan.tree_of[i] == kNone) continue;
    const ObjectTree& tree = image.trees[plan.tree_of[i]];
    record.root = tree.first_node;
    const glm::mat4 to_world = tree.in_world ? glm::mat4(1) : scene.instances[i].to_world;
    Bounds box;
    for (const TriangleRecord& t : std::span(image.triangles).subspan(tree.first_triangle, tree.triangles)) {
      for (const glm::vec3& v : {t.v0, t.v1, t.v2}) box.add(glm::vec3(to_world * glm::vec4(v, 1)) + 0.0F);
    }
    shown.push_back(i);
    boxes.push_back(box);
    all.add(box.lower);
    all.add(box.upper);
  }
  if (!all.empty()) {
    image.lower = all.lower;
    image.upper = all.upper;
  }
  for (std::size_t k = 0; k < shown.size(); ++k) {
    boxes[k] = pad_box(boxes[k], plan.placements[shown[k]], scene.instances[shown[k]].to_world, all);
  }
  FlatBvh top = builder.build_over(std::span<const Bounds>(boxes));
  image.build_statistics[0] = std::move(top.statistics);
  if (!config.is_wide()) {
    name_instances(top.nodes, top.order, shown);
    std::ranges::copy(top.nodes, image.nodes.begin());
    return;
  }
  WideBvh wide = collapse_tree(top, config, 1);
  if (is_quantised(image.wide_format)) quantise_nodes(wide.nodes, image.wide_format);
  name_instances(wide.nodes, wide.order, shown);
  replace_top(wide.nodes, image);
}

/// Returns the number of inner nodes of a tree with `leaves` leaves of one item each.
std::size_t inner_node_count(std::size_t leaves) { return std::max<std::size_t>(leaves, 2) - 1; }

}  // namespace

MemoryImage build_two_levels(const Scene& scene, const MaterialTables& materials, const BvhConfig& config,
                             unsigned threads, sim::Stop stop) {
  check_meshes(scene);
  TreePlan plan(scene);
  check_triangle_count(plan.triangles);
  MemoryImage image;
  image.trees = plan.trees;
  image.tree_of = plan.tree_of;
  image.build_statistics.resize(1 + plan.trees.size());
  image.triangles.reserve(plan.triangles);
  for (const ObjectTree& tree : image.trees) {
    append_triangles(placed_mesh_of(scene, tree), materials, tree.first_triangle, image.triangles);
  }
  const BvhBuilder builder(config, threads, stop);
  const auto shown = std::ranges::count_if(plan.tree_of, [](std::uint32_t tree) { return tree != kNone; });
  image.leaf_format = config.leaf;
  if (config.is_wide()) {
    image.wide_format = config.node_format();
    image.width = config.width;
    image.child_order = config.order;
  } else {
    image.nodes.resize(inner_node_count(static_cast<std::size_t>(shown)));
  }
  for (ObjectTree& tree : image.trees) add_tree(builder, config, tree, image);
  image.attributes.resize(plan.triangles);
  if (materials.needs_vertices) image.vertices.resize(plan.triangles);
  for (const ObjectTree& tree : image.trees) {
    const PlacedMesh placed = placed_mesh_of(scene, tree);
    store_shading(shading_records({&placed, 1}, materials), tree, image);
  }
  place_instances(scene, plan, builder, config, image);
  return image;
}

bool update_two_levels(const Scene& posed, const BvhConfig& config, unsigned threads, MemoryImage& image,
                       sim::Stop stop) {
  const TreePlan plan(posed);
  if (!plan.matches_image(image)) return false;
  const MaterialTables materials = material_tables(posed, image.has_mip_maps());
  const BvhBuilder builder(config, threads, stop);
  const bool refits = config.update == BvhUpdate::kRefit;
  const auto own = std::ranges::find_if(image.trees, [](const ObjectTree& tree) { return tree.only != kNone; });
  if (!refits && own != image.trees.end()) {
    config.is_wide() ? image.wide_nodes.resize(own->first_node) : image.nodes.resize(own->first_node);
  }
  for (auto tree = own; tree != image.trees.end(); ++tree) {
    const PlacedMesh placed = placed_mesh_of(posed, *tree);
    std::vector<TriangleRecord> moved;
    append_triangles(placed, materials, 0, moved);
    if (refits) {
      for (TriangleRecord& t : tree_records(image.triangles, *tree)) t = moved[t.source];
      recompute_boxes(image, tree->first_node,
                      tree + 1 == image.trees.end() ? image.node_count() : (tree + 1)->first_node);
    } else {
      std::ranges::copy(moved, tree_records(image.triangles, *tree).begin());
      add_tree(builder, config, *tree, image);
    }
    store_shading(shading_records({&placed, 1}, materials), *tree, image);
  }
  place_instances(posed, plan, builder, config, image);
  if (refits && image.leaf_format != LeafFormat::kTriangles) {
    cut_records(image.triangles, triangle_leaves(image), image.leaf_format, image.begins_record);
  }
  image.lights = posed.lights;
  image.layout = layout_of(counts_of(image), image, config);
  return true;
}

Ray to_object_space(const InstanceRecord& instance, const Ray& ray) {
  Ray out = ray;
  for (int row = 0; row < 3; ++row) {
    const auto& m = instance.to_object[row];
    out.origin[row] = m[0] * ray.origin.x + m[1] * ray.origin.y + m[2] * ray.origin.z + m[3];
    out.direction[row] = m[0] * ray.direction.x + m[1] * ray.direction.y + m[2] * ray.direction.z;
  }
  return out;
}

}  // namespace traces
