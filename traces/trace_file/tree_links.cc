#include "traces/trace_file/tree_links.h"

#include <algorithm>
#include <span>

#include "traces/trace_file/bytes.h"
#include "traces/walk.h"

namespace traces {
namespace {

// How a child of a tree node is encoded: 0 (none), an even number (twice the distance to an inner node) or an odd one
// (a leaf). A leaf has, above its lowest bit, 3 bits of its size less one, then the difference between its first
// triangle (or instance) and the end of the previous leaf. An instance is encoded as 0 (no tree) or 1 plus the index of
// its tree.
constexpr std::uint64_t kNothing = 0;

/// Where the previous leaf of triangles and the previous leaf of instances ended.
struct LeafEnds {
  std::int64_t of_triangles = 0, of_instances = 0;
};

std::uint64_t leaf_code(std::uint32_t link, LeafEnds& ends) {
  const bool enters = is_instance(link);
  std::int64_t& end = enters ? ends.of_instances : ends.of_triangles;
  const std::int64_t first = enters ? link_instance(link) : leaf_first(link);
  const std::uint32_t count = leaf_count(link);
  const std::int64_t moved = first - end;
  end = first + count;
  const std::uint64_t code = (static_cast<std::uint64_t>(moved) << 1) ^ static_cast<std::uint64_t>(moved >> 63);
  return code << 4 | (count - 1) << 1 | 1;
}

/// Decodes the links of a BVH, child by child.
class Decoder {
 public:
  Decoder(std::string_view bytes, const ImageCounts& counts)
      : from_(bytes),
        counts_(counts),
        triangles_(std::min<std::uint64_t>(counts.triangles, kMaxTriangles)),
        has_levels_(counts.instances != 0) {}

  Links decode_nodes(std::uint64_t nodes, std::uint32_t slots) {
    if (slots == 0) {
      links_.nodes.resize(nodes);
    } else {
      std::array<std::uint32_t, kMaxWidth> none;
      none.fill(kNoChild);
      links_.wide_nodes.assign(nodes, none);
      links_.slots = slots;
    }
    depth_.assign(nodes, 0);
    is_upper_.assign(nodes, false);
    seen_.assign(counts_.instances, false);
    is_upper_[0] = has_levels_;
    for (std::uint32_t node = 0; node < nodes; ++node) {
      if (depth_[node] == 0) begin_tree(node);
      if (depth_[node] > kMaxTreeDepth) throw sim::InputError("tree: is too deep; allowed: 128 levels");
      for (std::uint32_t& link : links_.children_of(node)) link = decode_child(node);
      if (links_.is_wide()) check_children(node);
    }
    if (links_.is_wide() && leaf_triangles_ != counts_.triangles) {
      throw sim::InputError("tree: its leaves have not as many triangles as the scene");
    }
    if (trees_.size() != counts_.trees) throw sim::InputError("tree: has not as many trees as it says");
    read_instances();
    if (from_.bytes_left() != 0) throw sim::InputError("tree: is longer than its nodes");
    return std::move(links_);
  }

 private:
  /// Begins a tree of the BVH at a node that no earlier node has as a child.
  void begin_tree(std::uint32_t node) {
    if (node != 0 && !has_levels_) throw sim::InputError("tree: a node has no parent");
    if (node != 0) trees_.push_back(node);
    depth_[node] = 1;
  }

  void check_children(std::uint32_t node) const {
    const std::span<const std::uint32_t> links = links_.children_of(node);
    const auto children = static_cast<std::ptrdiff_t>(links.size()) - std::ranges::count(links, kNoChild);
    if (children < 2 && depth_[node] != 1) throw sim::InputError("tree: a node has fewer than two children");
  }

  std::uint32_t decode_child(std::uint32_t node) {
    const std::uint64_t code = from_.read_number();
    if (code == kNothing && (depth_[node] == 1 || links_.is_wide())) return kNoChild;
    return (code & 1) == 0 ? decode_inner(node, code >> 1) : decode_leaf(node, code);
  }

  std::uint32_t decode_inner(std::uint32_t node, std::uint64_t distance) {
    if (distance == 0 || distance >= links_.node_count() - node) ByteReader::throw_out_of_range("tree: a child");
    const std::uint32_t link = node + static_cast<std::uint32_t>(distance);
    if (depth_[link] != 0) throw sim::InputError("tree: a node has two parents");
    depth_[link] = static_cast<std::uint8_t>(depth_[node] + 1);
    is_upper_[link] = is_upper_[node];
    return link;
  }

  std::uint32_t decode_leaf(std::uint32_t node, std::uint64_t code) {
    const bool enters = is_upper_[node];
    std::uint64_t& end = enters ? instances_end_ : triangles_end_;
    const std::uint64_t all = enters ? counts_.instances : triangles_, most = enters ? 1 : kMaxLeafTriangles;
    const auto count = static_cast<std::uint32_t>(code >> 1 & 7) + 1;
    const std::uint64_t moved = code >> 4;
    const std::uint64_t first = end + ((moved >> 1) ^ (~(moved & 1) + 1));
    if (first > all || count > all - first || count > most) ByteReader::throw_out_of_range("tree: a leaf");
    end = first + count;
    if (!enters) {
      leaf_triangles_ += count;
      return leaf_link(static_cast<std::uint32_t>(first), count);
    }
    if (seen_[first]) throw sim::InputError("tree: an instance is there twice");
    seen_[first] = true;
    return instance_link(static_cast<std::uint32_t>(first));
  }

  void read_instances() {
    std::vector<bool> has_instance(trees_.size(), false);
    links_.roots.assign(counts_.instances, kNone);
    for (std::uint64_t i = 0; i < counts_.instances; ++i) {
      const std::uint64_t code = from_.read_number(trees_.size(), "tree: an instance's tree");
      if (seen_[i] != (code != kNothing)) throw sim::InputError("tree: an instance without a tree, or without a place");
      if (code == kNothing) continue;
      links_.roots[i] = trees_[code - 1];
      has_instance[code - 1] = true;
    }
    if (std::ranges::count(has_instance, false) != 0) throw sim::InputError("tree: a tree has no instance");
  }

  ByteReader from_;
  const ImageCounts& counts_;
  const std::uint64_t triangles_;
  const bool has_levels_;
  Links links_;
  std::vector<std::uint8_t> depth_;    ///< depth of each node; 0 if no parent has been read yet
  std::vector<bool> is_upper_, seen_;  ///< nodes of the tree over instances; instances found in it
  std::vector<std::uint32_t> trees_;   ///< roots of the trees below the tree over instances
  std::uint64_t triangles_end_ = 0, instances_end_ = 0;
  std::uint64_t leaf_triangles_ = 0;  ///< triangles of all leaves read
};

}  // namespace

Links links_of(const MemoryImage& image) {
  Links links;
  for (const NodeRecord& node : image.nodes) links.nodes.push_back({node.child[0], node.child[1]});
  for (const WideNode& node : image.wide_nodes) std::ranges::copy(node.child, links.wide_nodes.emplace_back().begin());
  if (image.is_wide()) links.slots = image.wide_slots();
  links.begins_record = image.begins_record;
  for (const std::uint32_t tree : image.tree_of) {
    links.roots.push_back(tree == kNone ? kNone : image.trees[tree].first_node);
  }
  return links;
}

std::string encode_child_links(const Links& links) {
  std::string out;
  ByteWriter to(out);
  LeafEnds ends;
  for (std::uint32_t node = 0; node < links.node_count(); ++node) {
    for (const std::uint32_t link : links.children_of(node)) {
      to.write_number(link == kNoChild ? kNothing
                      : is_leaf(link)  ? leaf_code(link, ends)
                                       : std::uint64_t{link - node} << 1);
    }
  }
  // Trees are numbered in the order of their root nodes.
  std::vector<std::uint32_t> trees = links.roots;
  std::ranges::sort(trees);
  trees.erase(std::unique(trees.begin(), trees.end()), trees.end());
  for (const std::uint32_t root : links.roots) {
    const auto index = std::ranges::lower_bound(trees, root) - trees.begin();
    to.write_number(root == kNone ? kNothing : static_cast<std::uint64_t>(index) + 1);
  }
  return out;
}

std::string encode_records(const std::vector<bool>& begins_record) {
  std::string out((begins_record.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < begins_record.size(); ++i) {
    if (begins_record[i]) out[i / 8] = static_cast<char>(out[i / 8] | 1 << (i % 8));
  }
  return out;
}

std::vector<bool> decode_records(std::string_view bytes, std::uint64_t triangles) {
  if (bytes.size() != (triangles + 7) / 8) ByteReader::throw_out_of_range("tree: number of leaf records");
  std::vector<bool> begins(triangles);
  for (std::size_t i = 0; i < triangles; ++i) begins[i] = (bytes[i / 8] >> (i % 8) & 1) != 0;
  if (triangles != 0 && !begins[0]) throw sim::InputError("tree: the first leaf record has no beginning");
  return begins;
}

Links decode_child_links(std::string_view bytes, std::uint64_t nodes, const ImageCounts& counts, std::uint32_t slots) {
  // Each child and each instance takes at least one byte.
  const std::uint64_t per_node = slots == 0 ? 2 : slots;
  if (nodes == 0 || nodes > kMaxNodes || per_node * nodes > bytes.size())
    ByteReader::throw_out_of_range("tree: number of nodes");
  if (counts.instances > bytes.size() - per_node * nodes) ByteReader::throw_out_of_range("tree: number of instances");
  return Decoder(bytes, counts).decode_nodes(nodes, slots);
}

}  // namespace traces
