#include "shader_kernels/programs/build_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/kernels/build_tree.h"
#include "traces/accel/node_format.h"

namespace kernels {
namespace {

using traces::Region;

constexpr std::uint32_t kDigits = 3, kDigitBits = 8, kDigitValues = 1U << kDigitBits;
constexpr std::uint64_t kCountsBytes = kDigitValues * sizeof(CountRecord<float>);
constexpr std::uint64_t kKeyBytes = sizeof(KeyRecord<float>), kLeafBytes = sizeof(BuildLeafRecord<float>);
constexpr std::uint64_t kCornerBytes = sizeof(CornersRecord<float>), kIndexBytes = 12;
constexpr std::uint64_t kNodeBytes = sizeof(BuildNodeRecord<float>), kBoxBytes = sizeof(BoxRecord<float>);
static_assert(kLeafBytes == 68 && kNodeBytes == 40 && sizeof(NodeFields<float>) == sizeof(traces::NodeRecord) &&
              sizeof(LeafFields<float>) == sizeof(traces::TriangleRecord));

BuildStream reads(std::uint64_t base, std::uint64_t bytes) { return {Region::kBuild, false, base, bytes, false}; }
BuildStream writes(std::uint64_t base, std::uint64_t bytes) { return {Region::kBuild, true, base, bytes, false}; }
BuildStream reads_by_batch(std::uint64_t base, std::uint64_t bytes) {
  return {Region::kBuild, false, base, bytes, true};
}
BuildStream writes_by_batch(std::uint64_t base, std::uint64_t bytes) {
  return {Region::kBuild, true, base, bytes, true};
}

/// Returns the bytes of a stream for items `first` to `end` - 1 of a pass.
std::pair<std::uint64_t, std::uint64_t> bytes_of(const KernelPass& pass, const BuildStream& stream, std::uint64_t first,
                                                 std::uint64_t end) {
  if (stream.by_batch) return {first / pass.batch * stream.bytes, (first / pass.batch + 1) * stream.bytes};
  return {stream.bytes * first / pass.items, stream.bytes * end / pass.items};
}

}  // namespace

std::uint64_t KernelPass::moved_bytes() const {
  std::uint64_t all = 0;
  for (const BuildStream& stream : streams) all += stream.bytes * (stream.by_batch ? entry_count() : 1);
  return all;
}

std::uint64_t KernelBuild::reserve(std::uint64_t bytes) {
  constexpr std::uint64_t kLine = 64;
  const std::uint64_t base = scratch_;
  scratch_ += (bytes + kLine - 1) / kLine * kLine;
  return base;
}

KernelBuild::KernelBuild(const traces::MemoryImage& image, std::uint32_t space) {
  const traces::Layout& layout = image.layout;
  const std::uint64_t n = image.triangles.size(), inner = n - 1, nodes = image.nodes.size();
  if (n < 2) return;
  const std::uint64_t input = reserve(n * (kCornerBytes + kIndexBytes)), leaves = reserve(n * kLeafBytes);
  const std::uint64_t keys[2] = {reserve(n * kKeyBytes), reserve(n * kKeyBytes)};
  const std::uint64_t visited = reserve(2 * inner * sizeof(CountRecord<float>)),
                      hierarchy = reserve(inner * kNodeBytes);
  const auto add = [&](const char* name, std::vector<traces::KernelId> kernels, std::uint64_t items,
                       std::vector<BuildStream> streams) {
    std::uint64_t per_item = 0, fixed = 0;
    for (const BuildStream& stream : streams) {
      (stream.by_batch ? fixed : per_item) += stream.by_batch ? stream.bytes : (stream.bytes + items - 1) / items;
    }
    const std::uint64_t room = std::max<std::uint64_t>(space, fixed + 16 * per_item) - fixed;
    const auto batch = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(room / per_item, 1, items));
    passes_.push_back({name, std::move(kernels), items, std::move(streams), batch});
    return passes_.back().entry_count();
  };
  add("leaf", {kKernelId<BuildLeaf>}, n,
      {reads(input, n * (kCornerBytes + kIndexBytes)), writes(leaves, n * kLeafBytes), writes(keys[0], n * kKeyBytes)});
  // The counts of all batches follow each other; the places of a scatter's batches too.
  const std::uint64_t counts = reserve(0);
  const std::uint32_t batches = add("histogram", std::vector<traces::KernelId>(kDigits, kKernelId<SortHistogram>), n,
                                    {reads(keys[0], n * kKeyBytes), writes_by_batch(counts, kDigits * kCountsBytes)});
  reserve(batches * kDigits * kCountsBytes);
  const std::uint64_t all_counts = batches * kDigits * kDigitValues;
  add("scan", {kKernelId<SortScan>}, all_counts, {reads(counts, all_counts * sizeof(CountRecord<float>))});
  const std::uint64_t places = reserve(0);
  std::uint32_t scatters = 0;
  for (std::uint32_t digit = 0; digit < kDigits; ++digit) {
    const std::uint64_t from = keys[digit % 2], to = keys[1 - digit % 2];
    scatters = add("scatter", {kKernelId<SortHistogram>, kKernelId<SortScatter>}, n,
                   {reads(from, n * kKeyBytes), reads_by_batch(places, kCountsBytes),
                    writes_by_batch(places, kCountsBytes), writes(to, n * kKeyBytes)});
  }
  reserve(scatters * kCountsBytes);
  const std::uint64_t sorted = keys[kDigits % 2];
  // Each node and triangle but the root reads the keys on both sides of its range, and marks its parent as visited.
  const BuildStream neighbours = reads(sorted, inner * kKeyBytes);
  add("link", {kKernelId<LinkNode>}, 2 * inner,
      {reads(sorted, n * kKeyBytes), neighbours, neighbours, neighbours, neighbours,
       writes(visited, 2 * inner * sizeof(CountRecord<float>))});
  // Half of the children are triangles.
  add("fit", {kKernelId<FitNode>}, inner,
      {reads(leaves, inner * kBoxBytes), reads(hierarchy, inner * kBoxBytes), writes(hierarchy, inner * kNodeBytes)});
  add("encode_nodes", {kKernelId<EncodeNode>}, nodes,
      {reads(hierarchy, inner * kNodeBytes), {Region::kTree, true, 0, nodes * layout.node_bytes, false}});
  add("encode_leaves", {kKernelId<EncodeLeaf>}, n,
      {reads(sorted, n * kKeyBytes),
       reads(leaves, n * kLeafBytes),
       {Region::kTree, true, layout.triangles - layout.nodes, layout.leaf_bytes, false}});
  tree_ = layout.triangles - layout.nodes + layout.leaf_bytes;
}

std::uint32_t KernelBuild::entry_count() const {
  std::uint32_t entries = 0;
  for (const KernelPass& pass : passes_) entries += pass.entry_count();
  return entries;
}

void KernelBuild::record_entry(std::uint32_t entry, StreamBuilder& stream, traces::TileWork& work) const {
  auto pass = passes_.begin();
  for (; entry >= pass->entry_count(); ++pass) entry -= pass->entry_count();
  work.after_all = entry == 0 && pass != passes_.begin();
  const std::uint64_t first = std::uint64_t{entry} * pass->batch;
  const std::uint64_t end = std::min(first + pass->batch, pass->items);
  const auto add_transfer = [&](const BuildStream& moved) {
    const auto [from, to] = bytes_of(*pass, moved, first, end);
    return stream.add_transfer(moved.region, moved.is_written, moved.base + from,
                               static_cast<std::uint32_t>(to - from));
  };
  std::vector<StreamBuilder::Node> inputs;
  for (const BuildStream& moved : pass->streams) {
    if (!moved.is_written) inputs.push_back(add_transfer(moved));
  }
  StreamBuilder::Node launch = StreamBuilder::kNone;
  for (const traces::KernelId kernel : pass->kernels) {
    const StreamBuilder::Node before = launch;
    launch = stream.add_launch(kernel, static_cast<std::uint32_t>(end - first), false);
    if (before != StreamBuilder::kNone) stream.add_wait(launch, before, traces::Edge::Kind::kAll);
    for (const StreamBuilder::Node input : inputs) stream.add_wait(launch, input, traces::Edge::Kind::kAll);
  }
  for (const BuildStream& moved : pass->streams) {
    if (moved.is_written) stream.add_wait(add_transfer(moved), launch, traces::Edge::Kind::kAll);
  }
}

namespace {

/// Runs kernel K over items 0 to `items` - 1.
template <class K>
void run_kernel(typename K::template Ports<float>& ports, std::size_t items) {
  for (std::uint32_t i = 0; i < items; ++i) K::template body<float>(i, ports);
}

using Keys = std::vector<KeyRecord<float>>;

/// Sorts keys by radix, digit by digit.
void sort_keys(Keys& keys) {
  Keys other(keys.size());
  for (std::uint32_t digit = 0; digit < kDigits; ++digit) {
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
    SortScatter::Ports<float> scatter;
    scatter.keys.bind(keys.data());
    scatter.places.bind(places.data());
    scatter.sorted.bind(other.data());
    scatter.digit_shift = kDigitBits * digit;
    run_kernel<SortScatter>(scatter, keys.size());
    keys.swap(other);
  }
}

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
  NodeWriter(const traces::MemoryImage& image, const std::vector<BuildLeafRecord<float>>& leaves) : image_(image) {
    for (const traces::TriangleRecord& t : image.triangles) {
      boxes_.push_back({leaves[t.source].lower, leaves[t.source].upper});
    }
  }

  void write(KernelBuildResult& result) {
    std::vector<BuildNodeRecord<float>> nodes(image_.nodes.size());
    std::vector<std::uint32_t> box_of(image_.nodes.size());
    for (std::size_t i = image_.nodes.size(); i-- > 0;) {
      const traces::NodeRecord& node = image_.nodes[i];
      std::uint32_t child[2] = {};
      for (std::size_t c = 0; c < 2; ++c) {
        const std::uint32_t link = node.child[c];
        child[c] = link == traces::kNoChild ? missing_child(node, c)
                   : traces::is_leaf(link)  ? box_of_leaf(link)
                                            : box_of[link];
      }
      nodes[i] = {{}, {}, child[0], child[1], node.child[0], node.child[1]};
      if (i != 0) box_of[i] = fit(nodes[i]);
    }
    // The root's box is not read, but its fit is work all the same.
    if (node_has_two_children(image_.nodes.front())) fit(nodes.front());
    result.nodes.resize(nodes.size());
    EncodeNode::Ports<float> ports;
    ports.nodes.bind(nodes.data());
    ports.boxes.bind(boxes_.data());
    ports.encoded.base = reinterpret_cast<std::byte*>(result.nodes.data());
    run_kernel<EncodeNode>(ports, nodes.size());
    result.unions = unions_;
  }

 private:
  static bool node_has_two_children(const traces::NodeRecord& node) {
    return node.child[0] != traces::kNoChild && node.child[1] != traces::kNoChild;
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
  std::vector<BoxRecord<float>> boxes_;  ///< of triangles in leaf order, then of nodes
  std::uint64_t unions_ = 0;
};

}  // namespace

KernelBuildResult run_build_kernels(const traces::MemoryImage& image) {
  const std::size_t n = image.triangles.size();
  std::vector<CornersRecord<float>> corners(n);
  Keys inputs(n), keys(n);
  std::vector<CountRecord<float>> objects(n);
  const auto vector = [](const glm::vec3& v) { return Vec3<float>{v.x, v.y, v.z}; };
  for (const traces::TriangleRecord& t : image.triangles) {
    corners[t.source] = {vector(t.v0), vector(t.v1), vector(t.v2)};
    inputs[t.source] = {t.material, t.source};
    objects[t.source] = {t.object};
  }
  std::vector<BuildLeafRecord<float>> leaves(n);
  BuildLeaf::Ports<float> leaf;
  leaf.corners.bind(corners.data());
  leaf.inputs.bind(inputs.data());
  leaf.leaves.bind(leaves.data());
  leaf.keys.bind(keys.data());
  constexpr float kCells = 256;
  const auto cells_per_half = [](float low, float high) { return high > low ? kCells / (2 * (high - low)) : 0.0F; };
  leaf.scene_lower = vector(image.lower + image.lower);
  leaf.grid_scale = {cells_per_half(image.lower.x, image.upper.x), cells_per_half(image.lower.y, image.upper.y),
                     cells_per_half(image.lower.z, image.upper.z)};
  run_kernel<BuildLeaf>(leaf, n);

  KernelBuildResult result;
  const auto copy = [](const Keys& from, std::vector<KernelBuildResult::Key>& to) {
    for (const KeyRecord<float>& key : from) to.push_back({key.key, key.number});
  };
  copy(keys, result.keys);
  sort_keys(keys);
  copy(keys, result.sorted);
  result.parents = link_nodes(keys);
  result.links = result.parents.size();
  NodeWriter(image, leaves).write(result);

  Keys in_leaf_order;
  for (const traces::TriangleRecord& t : image.triangles) in_leaf_order.push_back({0, t.source});
  result.leaves.resize(n);
  EncodeLeaf::Ports<float> encode;
  encode.sorted.bind(in_leaf_order.data());
  encode.leaves.bind(leaves.data());
  encode.objects.bind(objects.data());
  encode.encoded_leaves.base = reinterpret_cast<std::byte*>(result.leaves.data());
  run_kernel<EncodeLeaf>(encode, n);
  return result;
}

}  // namespace kernels
