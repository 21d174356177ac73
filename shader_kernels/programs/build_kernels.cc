#include "shader_kernels/programs/build_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/kernels/build_tree.h"
#include "shader_kernels/kernels/collapse.h"
#include "shader_kernels/kernels/pose.h"
#include "traces/accel/node_format.h"

namespace kernels {
namespace {

using traces::Region;
using Share = PassStream::Share;
using Boxes = std::vector<BoxRecord<float>>;
using Keys = std::vector<KeyRecord<float>>;

constexpr std::uint32_t kDigitBits = 8, kDigitValues = 1U << kDigitBits;
constexpr std::uint64_t kCountsBytes = kDigitValues * sizeof(CountRecord<float>);
constexpr std::uint64_t kKeyBytes = sizeof(KeyRecord<float>), kLeafRecordBytes = sizeof(BuildLeafRecord<float>);
constexpr std::uint64_t kTriangleBytes = sizeof(CornersRecord<float>) + 12;  // and three vertex numbers
constexpr std::uint64_t kLabelBytes = sizeof(LabelRecord<float>);
constexpr std::uint64_t kNodeBytes = sizeof(BuildNodeRecord<float>), kBoxBytes = sizeof(BoxRecord<float>);
constexpr std::uint64_t kGridBytes = sizeof(GridRecord<float>), kInstanceBytes = sizeof(PosedInstanceRecord<float>);
static_assert(kLeafRecordBytes == 48 && kNodeBytes == 40 && sizeof(NodeFields<float>) == sizeof(traces::NodeRecord) &&
              sizeof(LeafFields<float>) == sizeof(traces::TriangleRecord) &&
              sizeof(EncodedInstance<float>) == sizeof(traces::InstanceRecord));

std::uint32_t digit_count(std::uint32_t morton_bits) { return (morton_bits + kDigitBits - 1) / kDigitBits; }

Vec3<float> vector_of(const glm::vec3& v) { return {v.x, v.y, v.z}; }

/// Runs kernel K over items 0 to `items` - 1.
template <class K>
void run_kernel(typename K::template Ports<float>& ports, std::size_t items) {
  for (std::uint32_t i = 0; i < items; ++i) K::template body<float>(i, ports);
}

/// Returns the Morton codes of boxes as keys, numbered by box, and computes the grid from the boxes.
Keys code_boxes(Boxes& boxes, std::uint32_t morton_bits) {
  const auto cells = static_cast<float>(1U << (morton_bits / 3));
  Boxes running(boxes.size());
  BoundCentres::Ports<float> bound;
  bound.boxes.bind(boxes.data());
  bound.bounds.bind(running.data());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (LoopCarried<float>* low : {&bound.running.x0, &bound.running.y0, &bound.running.z0}) low->set(kInfinity);
  for (LoopCarried<float>* high : {&bound.running.x1, &bound.running.y1, &bound.running.z1}) high->set(-kInfinity);
  run_kernel<BoundCentres>(bound, boxes.size());
  GridRecord<float> grid{};
  MakeGrid::Ports<float> make;
  make.bounds.bind(&running.back());
  make.grids.bind(&grid);
  make.cells = cells;
  run_kernel<MakeGrid>(make, 1);
  Keys keys(boxes.size());
  MortonCode::Ports<float> code;
  code.boxes.bind(boxes.data());
  code.keys.bind(keys.data());
  code.grid_lower = grid.lower;
  code.grid_scale = grid.scale;
  code.last_cell = cells - 1;
  code.first_number = 0;
  run_kernel<MortonCode>(code, boxes.size());
  return keys;
}

/// Sorts the keys of a range by one digit, stably. `places`: for each digit, the place of its next key in `to`.
void scatter_keys(std::span<KeyRecord<float>> keys, std::uint32_t digit, std::vector<CountRecord<float>>& places,
                  Keys& to) {
  SortScatter::Ports<float> scatter;
  scatter.keys.bind(keys.data());
  scatter.places.bind(places.data());
  scatter.sorted.bind(to.data());
  scatter.digit_shift = kDigitBits * digit;
  run_kernel<SortScatter>(scatter, keys.size());
}

/// Returns the place of the first key of each digit.
std::vector<CountRecord<float>> places_of(Keys& keys, std::uint32_t digit) {
  std::vector<CountRecord<float>> counts(kDigitValues), places(kDigitValues);
  SortHistogram::Ports<float> histogram;
  histogram.keys.bind(keys.data());
  histogram.counts.bind(counts.data());
  histogram.digit_shift = kDigitBits * digit;
  run_kernel<SortHistogram>(histogram, keys.size());
  SortScan::Ports<float> scan;
  scan.counts.bind(counts.data());
  scan.places.bind(places.data());
  run_kernel<SortScan>(scan, kDigitValues);
  return places;
}

/// Sorts keys by one digit, batch by batch. Returns the pieces of the sorted array that each batch writes: the run of
/// each digit, and runs that adjoin as one.
PassStream scatter_batches(Keys& keys, std::uint32_t digit, std::uint32_t batch) {
  PassStream written{.is_written = true, .bytes = keys.size() * kKeyBytes, .share = Share::kPieces};
  std::vector<CountRecord<float>> places = places_of(keys, digit);
  Keys sorted(keys.size());
  for (std::size_t first = 0; first < keys.size(); first += batch) {
    const std::vector<CountRecord<float>> before = places;
    scatter_keys(std::span(keys).subspan(first, std::min<std::size_t>(batch, keys.size() - first)), digit, places,
                 sorted);
    written.first_piece.push_back(static_cast<std::uint32_t>(written.pieces.size()));
    for (std::size_t value = 0; value < kDigitValues; ++value) {
      const std::uint64_t begin = before[value].number * kKeyBytes, end = places[value].number * kKeyBytes;
      if (begin == end) continue;
      const bool adjoins = written.pieces.size() > written.first_piece.back() && written.pieces.back().end == begin;
      if (adjoins) {
        written.pieces.back().end = end;
      } else {
        written.pieces.push_back({begin, end});
      }
    }
  }
  written.first_piece.push_back(static_cast<std::uint32_t>(written.pieces.size()));
  keys.swap(sorted);
  return written;
}

/// A tree within the image: its nodes from first to end - 1, and its first triangle.
struct TreePart {
  std::uint32_t first_node = 0, end_node = 0, first_triangle = 0;
};

/// Returns the parts of the trees that a frame builds, in the order of traces::tree_builds().
std::vector<TreePart> parts_of(const traces::MemoryImage& image) {
  const auto nodes = static_cast<std::uint32_t>(image.node_count());
  if (!image.has_two_levels()) return {{0, nodes, 0}};
  std::vector<TreePart> parts{{0, image.trees.empty() ? nodes : image.trees.front().first_node, 0}};
  for (std::size_t i = 0; i < image.trees.size(); ++i) {
    const traces::ObjectTree& tree = image.trees[i];
    if (tree.only == traces::kNone || tree.triangles == 0) continue;
    const bool is_last = i + 1 == image.trees.size();
    parts.push_back({tree.first_node, is_last ? nodes : image.trees[i + 1].first_node, tree.first_triangle});
  }
  return parts;
}

BoxRecord<float> child_box(const traces::MemoryImage& image, std::uint32_t node, std::size_t c) {
  if (image.is_wide()) {
    const auto& p = image.wide_nodes[node].planes;
    return {{p[0][0][c], p[1][0][c], p[2][0][c]}, {p[0][1][c], p[1][1][c], p[2][1][c]}};
  }
  const traces::NodeRecord& n = image.nodes[node];
  return {{n.x[c], n.y[c], n.z[c]}, {n.x[2 + c], n.y[2 + c], n.z[2 + c]}};
}

/// Returns the boxes of a tree's triangles or instances, in input order.
Boxes boxes_of(const traces::MemoryImage& image, const traces::TreeBuild& build, const TreePart& part) {
  Boxes boxes(build.items);
  if (build.job.input == traces::BuildWork::Input::kInstances) {
    for (std::uint32_t node = part.first_node; node < part.end_node; ++node) {
      const std::span<const std::uint32_t> links = image.links_of(node);
      for (std::size_t c = 0; c < links.size(); ++c) {
        if (traces::is_instance(links[c])) boxes[traces::link_instance(links[c])] = child_box(image, node, c);
      }
    }
    return boxes;
  }
  for (const traces::TriangleRecord& t : std::span(image.triangles).subspan(part.first_triangle, build.items)) {
    boxes[t.source] = {vector_of(glm::min(glm::min(t.v0, t.v1), t.v2)),
                       vector_of(glm::max(glm::max(t.v0, t.v1), t.v2))};
  }
  return boxes;
}

/// Stages of builds and refits, after the one that poses geometry.
enum Stage : std::uint32_t {
  kLeaves = kPoseStage + 1,
  kBounds,
  kCode,
  kHistogram,
  kScan,
  kScatter,  ///< a stage per digit
  kLink = kScatter + 4,
  kFit,
  kCollapse,
  kEncode,
};

/// Adds the passes of one tree.
class TreePasses {
 public:
  TreePasses(const traces::MemoryImage& image, const traces::TreeBuild& build, const TreePart& part,
             std::uint32_t morton_bits, KernelPasses& passes)
      : image_(image), build_(build), part_(part), morton_bits_(morton_bits), passes_(passes) {
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      tree_[i] = {Region::kTree, true, build.job.output[i].offset, build.job.output[i].bytes};
    }
    if (tree_[1].bytes == 0) {  // nodes and leaves are mixed in one array, which the passes write in two parts
      tree_[1].bytes = n_ * (has_instances() ? sizeof(traces::InstanceRecord) : image.layout.triangle_bytes);
      tree_[0].bytes -= tree_[1].bytes;
      tree_[1].base = tree_[0].base + tree_[0].bytes;
    }
    for (std::uint32_t node = part.first_node; node < part.end_node; ++node) {
      for (const std::uint32_t link : image.links_of(node)) {
        if (link == traces::kNoChild) continue;
        children_ += 1;
        leaves_ += traces::is_leaf(link) ? 1 : 0;
      }
    }
  }

  void add_build() {
    const std::uint64_t boxes = passes_.reserve(n_ * kBoxBytes);
    const std::uint64_t grid = add_leaf_pass(boxes);
    keys_ = {passes_.reserve(n_ * kKeyBytes), passes_.reserve(n_ * kKeyBytes)};
    passes_.add(kCode, "code", {{kKernelId<MortonCode>, n_}}, n_,
                {read_stream(boxes, n_ * kBoxBytes), read_stream(grid, kGridBytes, Share::kAll),
                 write_stream(keys_[0], n_ * kKeyBytes)});
    const std::uint64_t sorted = add_sort_passes();
    add_hierarchy_passes(boxes, sorted);
    if (has_instances()) {
      passes_.add(kEncode, "encode_leaves", {{kKernelId<PoseInstance>, n_}}, n_,
                  {read_stream(input_, n_ * kInstanceBytes), tree_[1]});
    } else {
      passes_
          .add(kEncode, "encode_leaves", {{kKernelId<EncodeLeaf>, n_}}, n_,
               {read_stream(sorted, n_ * kKeyBytes), tree_[1]})
          ->gather = {records_, kLeafRecordBytes, build_.order};
    }
  }

  void add_refit() {
    const std::uint64_t input = passes_.reserve(n_ * kTriangleBytes);
    const std::uint64_t leaf_boxes = passes_.reserve(leaves_ * kBoxBytes);
    const std::uint64_t node_boxes = passes_.reserve(nodes_ * kBoxBytes);
    PassStream old_leaves = tree_[1], old_nodes = tree_[0];
    old_leaves.is_written = old_nodes.is_written = false;
    passes_.add(
        kLeaves, "refit_leaves", {{kKernelId<RefitLeaf>, n_}, {kKernelId<FitNode>, n_ - leaves_}}, n_,
        {read_stream(input, n_ * kTriangleBytes), old_leaves, tree_[1], write_stream(leaf_boxes, leaves_ * kBoxBytes)});
    std::vector<PassKernel> kernels{{kKernelId<RefitNode>, nodes_}};
    if (image_.is_wide()) kernels = {{kKernelId<FitNode>, children_ - nodes_}, {child_kernel(), children_}};
    // The children of all nodes are the leaves, and all nodes but the root.
    passes_.add(
        kFit, "refit_nodes", std::move(kernels), nodes_,
        {old_nodes, read_stream(leaf_boxes, leaves_ * kBoxBytes), read_stream(node_boxes, (nodes_ - 1) * kBoxBytes),
         tree_[0], write_stream(node_boxes, nodes_ * kBoxBytes)});
  }

 private:
  bool has_instances() const { return build_.job.input == traces::BuildWork::Input::kInstances; }
  /// Returns the kernel that writes a child of a wide node.
  traces::KernelId child_kernel() const {
    return traces::is_quantised(image_.wide_format) ? kKernelId<QuantiseChild> : kKernelId<EncodeChild>;
  }

  /// Adds the passes that compute boxes, and the grid of Morton codes, whose place is returned.
  std::uint64_t add_leaf_pass(std::uint64_t boxes) {
    const traces::KernelId leaf = has_instances() ? kKernelId<BoundInstance> : kKernelId<BuildLeaf>;
    const std::uint64_t input_bytes = has_instances() ? kInstanceBytes : kTriangleBytes + kLabelBytes;
    input_ = passes_.reserve(n_ * input_bytes);
    std::vector<PassStream> streams = {read_stream(input_, n_ * input_bytes), write_stream(boxes, n_ * kBoxBytes)};
    if (has_instances()) {
      streams.push_back(read_stream(passes_.reserve(n_ * kBoxBytes), n_ * kBoxBytes));  // boxes of meshes
    } else {
      streams.push_back(write_stream(passes_.reserve(n_ * kLeafRecordBytes), n_ * kLeafRecordBytes));
      records_ = streams.back().base;
    }
    const std::uint64_t bounds = passes_.reserve(0);  // a box per batch
    streams.push_back(write_stream(bounds, kBoxBytes, Share::kBatch));
    const std::uint32_t batches =
        passes_.add(kLeaves, "leaf", {{leaf, n_}, {kKernelId<BoundCentres>, n_}}, n_, std::move(streams))
            ->entry_count();
    passes_.reserve(batches * kBoxBytes);
    const std::uint64_t grid = passes_.reserve(kGridBytes);
    passes_.add(kBounds, "bounds", {{kKernelId<BoundBatches>, batches}, {kKernelId<MakeGrid>, 1}}, batches,
                {read_stream(bounds, batches * kBoxBytes), write_stream(grid, kGridBytes, Share::kAll)});
    return grid;
  }

  /// Adds the passes that sort keys, and returns the place of the sorted keys.
  std::uint64_t add_sort_passes() {
    const std::uint32_t digits = digit_count(morton_bits_);
    // The counts of all batches follow each other; the places of a scatter's batches too.
    const std::uint64_t counts = passes_.reserve(0);
    const KernelPass* counted = passes_.add(
        kHistogram, "histogram", std::vector<PassKernel>(digits, PassKernel{kKernelId<SortHistogram>, n_}), n_,
        {read_stream(keys_[0], n_ * kKeyBytes), write_stream(counts, digits * kCountsBytes, Share::kBatch)});
    const std::uint64_t all_counts = std::uint64_t{counted->entry_count()} * digits * kDigitValues;
    const std::uint64_t count_bytes = all_counts * sizeof(CountRecord<float>);
    passes_.reserve(count_bytes);
    const std::uint64_t offsets = passes_.reserve(count_bytes);
    passes_.add(kScan, "scan", {{kKernelId<SortScan>, all_counts}}, all_counts,
                {read_stream(counts, count_bytes), write_stream(offsets, count_bytes)});
    const std::uint64_t places = passes_.reserve(0);
    std::uint32_t batches = 0;
    Boxes boxes = boxes_of(image_, build_, part_);
    Keys keys = code_boxes(boxes, morton_bits_);
    for (std::uint32_t digit = 0; digit < digits; ++digit) {
      const std::uint64_t from = keys_[digit % 2], to = keys_[1 - digit % 2];
      KernelPass* pass =
          passes_.add(kScatter + digit, "scatter", {{kKernelId<SortHistogram>, n_}, {kKernelId<SortScatter>, n_}}, n_,
                      {read_stream(from, n_ * kKeyBytes), read_stream(places, kCountsBytes, Share::kBatch),
                       write_stream(places, kCountsBytes, Share::kBatch), write_stream(to, n_ * kKeyBytes)});
      pass->streams.back() = scatter_batches(keys, digit, pass->batch);
      pass->streams.back().base = to;
      batches = pass->entry_count();
    }
    passes_.reserve(batches * kCountsBytes);
    return keys_[digits % 2];
  }

  void add_hierarchy_passes(std::uint64_t boxes, std::uint64_t sorted) {
    const std::uint64_t inner = n_ - 1;
    const std::uint64_t visited = passes_.reserve(2 * inner * sizeof(CountRecord<float>));
    const std::uint64_t hierarchy = passes_.reserve(inner * kNodeBytes);
    // Each node and triangle but the root reads the keys on both sides of its range, and marks its parent as visited.
    const PassStream neighbours = read_stream(sorted, inner * kKeyBytes);
    passes_.add(kLink, "link", {{kKernelId<LinkNode>, 2 * inner}}, 2 * inner,
                {read_stream(sorted, n_ * kKeyBytes), neighbours, neighbours, neighbours, neighbours,
                 write_stream(visited, 2 * inner * sizeof(CountRecord<float>))});
    // Half of the children are triangles.
    passes_.add(kFit, "fit", {{kKernelId<FitNode>, inner}}, inner,
                {read_stream(boxes, inner * kBoxBytes), read_stream(hierarchy, inner * kBoxBytes),
                 write_stream(hierarchy, inner * kNodeBytes)});
    if (image_.is_wide()) return add_wide_passes(boxes, hierarchy);
    passes_.add(kEncode, "encode_nodes", {{kKernelId<EncodeNode>, nodes_}}, nodes_,
                {read_stream(hierarchy, inner * kNodeBytes), tree_[0]});
  }

  /// Adds the passes that collapse the hierarchy to wide nodes. Each node that a wide node replaces is opened once.
  void add_wide_passes(std::uint64_t boxes, std::uint64_t hierarchy) {
    const std::uint64_t opened = children_ - nodes_, ids = passes_.reserve(children_ * sizeof(CountRecord<float>));
    const std::uint64_t id_bytes = children_ * sizeof(CountRecord<float>);
    passes_.add(kCollapse, "collapse", {{kKernelId<CollapseNode>, opened}}, opened,
                {read_stream(hierarchy, opened * kNodeBytes), read_stream(boxes, leaves_ * kBoxBytes),
                 write_stream(ids, id_bytes)});
    passes_.add(kEncode, "encode_nodes", {{child_kernel(), children_}}, children_,
                {read_stream(ids, id_bytes), read_stream(boxes, leaves_ * kBoxBytes),
                 read_stream(hierarchy, (nodes_ - 1) * kBoxBytes), tree_[0]});
  }

  const traces::MemoryImage& image_;
  const traces::TreeBuild& build_;
  const TreePart part_;
  const std::uint32_t morton_bits_;
  KernelPasses& passes_;
  const std::uint64_t n_ = build_.items;
  const std::uint64_t nodes_ = part_.end_node - part_.first_node;
  std::uint64_t children_ = 0, leaves_ = 0;  ///< children of all nodes, and of these leaves
  std::uint64_t input_ = 0, records_ = 0;
  std::array<std::uint64_t, 2> keys_{};
  std::array<PassStream, 2> tree_;  ///< nodes, and leaf records or instances
};

}  // namespace

void add_build_passes(const traces::MemoryImage& image, const traces::TreeBuilds& builds, KernelPasses& passes) {
  if (builds.trees.empty()) return;
  const std::vector<TreePart> parts = parts_of(image);
  for (std::size_t i = 0; i < builds.trees.size(); ++i) {
    const traces::TreeBuild& build = builds.trees[i];
    TreePasses tree(image, build, parts.at(i), builds.morton_bits, passes);
    if (build.job.refit) {
      tree.add_refit();
    } else {
      tree.add_build();
    }
  }
}

std::uint64_t end_of_trees(const traces::TreeBuilds& builds) {
  std::uint64_t end = 0;
  for (const traces::TreeBuild& build : builds.trees) {
    for (const traces::BuildWork::Range& range : build.job.output) end = std::max(end, range.offset + range.bytes);
  }
  return end;
}

namespace {

/// Builds the hierarchy over sorted keys bottom up. A node is linked once both of its halves are complete. Returns the
/// parent of each visit: first of each triangle, then of inner nodes as they are completed.
std::vector<std::uint32_t> link_nodes(Keys& sorted) {
  const auto last = static_cast<std::uint32_t>(sorted.size() - 1);
  RangeRecord<float> range{};
  CountRecord<float> parent{};
  LinkNode::Ports<float> ports;
  ports.ranges.bind(&range);
  ports.sorted.bind(sorted.data());
  ports.parents.bind(&parent);
  ports.last_triangle = last;
  constexpr std::uint32_t kNotVisited = 0xffffffffU;
  std::vector<std::uint32_t> parents,
      other_end(sorted.size(), kNotVisited);  // by boundary: end of the half that arrived first
  for (std::uint32_t triangle = 0; triangle <= last; ++triangle) {
    range = {triangle, triangle};
    while (range.first != 0 || range.last != last) {
      LinkNode::body<float>(0U, ports);
      parents.push_back(parent.number);
      const bool is_left = parent.number == range.last && range.last != last;
      const std::uint32_t boundary = parent.number;
      if (other_end[boundary] == kNotVisited) {
        other_end[boundary] = is_left ? range.first : range.last;
        break;
      }
      (is_left ? range.last : range.first) = other_end[boundary];
    }
  }
  return parents;
}

/// Computes the boxes of all nodes and writes their records.
class NodeWriter {
 public:
  /// `boxes`: of the image's triangles, in input order.
  NodeWriter(const traces::MemoryImage& image, const Boxes& boxes) : image_(image) {
    for (const traces::TriangleRecord& t : image.triangles) boxes_.push_back(boxes[t.source]);
  }

  /// Writes the nodes of a build: first the hierarchy, then its records.
  void encode(KernelBuildResult& result) {
    std::vector<BuildNodeRecord<float>> nodes(image_.nodes.size());
    std::vector<std::uint32_t> box_of(image_.nodes.size());
    for (std::size_t i = image_.nodes.size(); i-- > 0;) {
      const traces::NodeRecord& node = image_.nodes[i];
      nodes[i] = {{}, {}, box_of_child(node, 0, box_of), box_of_child(node, 1, box_of), node.child[0], node.child[1]};
      if (i != 0) box_of[i] = fit(nodes[i]);
    }
    // The root's box is not read, but its fit is work all the same.
    if (has_two_children(image_.nodes.front())) fit(nodes.front());
    result.nodes.resize(nodes.size());
    EncodeNode::Ports<float> ports;
    ports.nodes.bind(nodes.data());
    ports.boxes.bind(boxes_.data());
    ports.encoded.base = reinterpret_cast<std::byte*>(result.nodes.data());
    run_kernel<EncodeNode>(ports, nodes.size());
    result.unions = unions_;
  }

  /// Writes the nodes of a refit, bottom up. Only links of the image's nodes are read.
  void refit(KernelBuildResult& result) {
    result.nodes.resize(image_.nodes.size());
    std::vector<std::uint32_t> box_of(image_.nodes.size());
    for (std::size_t i = image_.nodes.size(); i-- > 0;) {
      const traces::NodeRecord& host = image_.nodes[i];
      NodeFields<float> node{};
      node.left_link = host.child[0], node.right_link = host.child[1];
      BoxRecord<float> children[2] = {boxes_[box_of_child(host, 0, box_of)], boxes_[box_of_child(host, 1, box_of)]};
      BoxRecord<float> fitted{};
      RefitNode::Ports<float> ports;
      ports.nodes.bind(&node);
      ports.boxes.bind(children);
      ports.fitted.bind(&fitted);
      ports.encoded.base = reinterpret_cast<std::byte*>(&result.nodes[i]);
      RefitNode::body<float>(0U, ports);
      box_of[i] = static_cast<std::uint32_t>(boxes_.size());
      boxes_.push_back(fitted);
    }
    result.unions = unions_;
  }

 private:
  static bool has_two_children(const traces::NodeRecord& node) {
    return node.child[0] != traces::kNoChild && node.child[1] != traces::kNoChild;
  }
  std::uint32_t box_of_child(const traces::NodeRecord& node, std::size_t c, const std::vector<std::uint32_t>& box_of) {
    const std::uint32_t link = node.child[c];
    if (link == traces::kNoChild) return missing_child(node, c);
    return traces::is_leaf(link) ? box_of_leaf(link) : box_of[link];
  }
  /// Adds the inverted box of a missing child, which no ray hits.
  std::uint32_t missing_child(const traces::NodeRecord& node, std::size_t c) {
    boxes_.push_back({{node.x[c], node.y[c], node.z[c]}, {node.x[2 + c], node.y[2 + c], node.z[2 + c]}});
    return static_cast<std::uint32_t>(boxes_.size() - 1);
  }
  std::uint32_t box_of_leaf(std::uint32_t link) {
    std::uint32_t box = traces::leaf_first(link);
    for (std::uint32_t k = 1; k < traces::leaf_count(link); ++k) {
      box = fit({{}, {}, box, traces::leaf_first(link) + k, 0, 0});
    }
    return box;
  }
  std::uint32_t fit(const BuildNodeRecord<float>& node) {
    BuildNodeRecord<float> one = node;
    BoxRecord<float> fitted{};
    FitNode::Ports<float> ports;
    ports.nodes.bind(&one);
    ports.boxes.bind(boxes_.data());
    ports.fitted.bind(&fitted);
    FitNode::body<float>(0U, ports);
    boxes_.push_back(fitted);
    unions_ += 1;
    return static_cast<std::uint32_t>(boxes_.size() - 1);
  }

  const traces::MemoryImage& image_;
  Boxes boxes_;  ///< of triangles in leaf order, then of nodes
  std::uint64_t unions_ = 0;
};

void copy_keys(const Keys& from, std::vector<KernelBuildResult::Key>& to) {
  for (const KeyRecord<float>& key : from) to.push_back({key.key, key.number});
}

}  // namespace

KernelBuildResult run_build_kernels(const traces::MemoryImage& image, std::uint32_t morton_bits) {
  const std::size_t n = image.triangles.size();
  std::vector<CornersRecord<float>> corners(n);
  std::vector<LabelRecord<float>> labels(n);
  for (const traces::TriangleRecord& t : image.triangles) {
    corners[t.source] = {vector_of(t.v0), vector_of(t.v1), vector_of(t.v2)};
    labels[t.source] = {t.material, t.object};
  }
  Boxes boxes(n);
  std::vector<BuildLeafRecord<float>> leaves(n);
  BuildLeaf::Ports<float> leaf;
  leaf.corners.bind(corners.data());
  leaf.labels.bind(labels.data());
  leaf.boxes.bind(boxes.data());
  leaf.leaves.bind(leaves.data());
  leaf.first_number = 0;
  run_kernel<BuildLeaf>(leaf, n);

  KernelBuildResult result;
  Keys keys = code_boxes(boxes, morton_bits);
  copy_keys(keys, result.keys);
  constexpr std::uint32_t kBatch = 1000;
  for (std::uint32_t digit = 0; digit < digit_count(morton_bits); ++digit) scatter_batches(keys, digit, kBatch);
  copy_keys(keys, result.sorted);
  result.parents = link_nodes(keys);
  result.links = result.parents.size();
  NodeWriter(image, boxes).encode(result);

  Keys in_leaf_order;
  for (const traces::TriangleRecord& t : image.triangles) in_leaf_order.push_back({0, t.source});
  result.leaves.resize(n);
  EncodeLeaf::Ports<float> encode;
  encode.sorted.bind(in_leaf_order.data());
  encode.stored.bind_raw(leaves.data(), nullptr);
  encode.encoded_leaves.base = reinterpret_cast<std::byte*>(result.leaves.data());
  run_kernel<EncodeLeaf>(encode, n);
  return result;
}

KernelBuildResult run_refit_kernels(const traces::MemoryImage& image) {
  const std::size_t n = image.triangles.size();
  std::vector<CornersRecord<float>> corners(n);
  std::vector<LeafFields<float>> old_leaves(n);
  for (std::size_t i = 0; i < n; ++i) {
    const traces::TriangleRecord& t = image.triangles[i];
    corners[i] = {vector_of(t.v0), vector_of(t.v1), vector_of(t.v2)};
    old_leaves[i].object = t.object, old_leaves[i].material = t.material, old_leaves[i].source = t.source;
  }
  Boxes fitted(n), boxes(n);
  KernelBuildResult result;
  result.leaves.resize(n);
  RefitLeaf::Ports<float> leaf;
  leaf.corners.bind(corners.data());
  leaf.old_leaves.bind(old_leaves.data());
  leaf.boxes.bind(fitted.data());
  leaf.encoded_leaves.base = reinterpret_cast<std::byte*>(result.leaves.data());
  run_kernel<RefitLeaf>(leaf, n);
  for (std::size_t i = 0; i < n; ++i) boxes[image.triangles[i].source] = fitted[i];
  NodeWriter(image, boxes).refit(result);
  return result;
}

}  // namespace kernels
