#include "traces/trace_file/tree_links.h"

#include <algorithm>

#include "traces/trace_file/bytes.h"
#include "traces/walk.h"

namespace traces {
namespace {

// A child is 0 (none), an even number (twice the distance to an inner node) or an odd one: a leaf, its size less one in
// the next three bits, above them the difference between its first triangle and the last leaf's end.
constexpr std::uint64_t kNothing = 0;

void check_depth(const Links& links) {
  std::vector<std::uint8_t> depth(links.size(), 0);  // 0: nobody's child yet
  depth[0] = 1;
  for (std::uint32_t node = 0; node < links.size(); ++node) {
    if (depth[node] == 0) throw sim::InputError("tree: a node has no parent");
    if (depth[node] > kMaxTreeDepth) throw sim::InputError("tree: is too deep; allowed: 128 levels");
    for (const std::uint32_t link : links[node]) {
      if (is_leaf(link) || link == kNoChild) continue;
      if (depth[link] != 0) throw sim::InputError("tree: a node has two parents");
      depth[link] = static_cast<std::uint8_t>(depth[node] + 1);
    }
  }
}

}  // namespace

Links links_of(const MemoryImage& image) {
  Links links(image.nodes.size());
  for (std::size_t i = 0; i < links.size(); ++i) links[i] = {image.nodes[i].child[0], image.nodes[i].child[1]};
  return links;
}

std::string encode_links(const Links& links) {
  std::string out;
  ByteWriter to(out);
  std::int64_t next = 0;
  for (std::uint32_t node = 0; node < links.size(); ++node) {
    for (const std::uint32_t link : links[node]) {
      if (link == kNoChild) {
        to.number(kNothing);
      } else if (!is_leaf(link)) {
        to.number(std::uint64_t{link - node} << 1);
      } else {
        const std::int64_t moved = std::int64_t{leaf_first(link)} - next;
        const std::uint64_t code = (static_cast<std::uint64_t>(moved) << 1) ^ static_cast<std::uint64_t>(moved >> 63);
        to.number(code << 4 | (leaf_count(link) - 1) << 1 | 1);
        next = std::int64_t{leaf_first(link)} + leaf_count(link);
      }
    }
  }
  return out;
}

Links decode_links(std::string_view bytes, std::uint64_t nodes, std::uint64_t triangles) {
  // A child takes a byte at least.
  if (nodes == 0 || nodes > kMaxNodes || 2 * nodes > bytes.size()) ByteReader::out_of_range("tree: number of nodes");
  triangles = std::min<std::uint64_t>(triangles, kMaxTriangles);
  Links links(nodes);
  ByteReader from(bytes);
  std::uint64_t next = 0;
  for (std::uint32_t node = 0; node < nodes; ++node) {
    for (std::uint32_t& link : links[node]) {
      const std::uint64_t code = from.number();
      if (code == kNothing && nodes == 1) {
        link = kNoChild;
      } else if ((code & 1) == 0) {
        if (code == kNothing || (code >> 1) >= nodes - node) ByteReader::out_of_range("tree: a child");
        link = node + static_cast<std::uint32_t>(code >> 1);
      } else {
        const auto count = static_cast<std::uint32_t>(code >> 1 & 7) + 1;
        const std::uint64_t moved = code >> 4;
        const std::uint64_t first = next + ((moved >> 1) ^ (~(moved & 1) + 1));
        if (first > triangles || count > triangles - first) ByteReader::out_of_range("tree: a leaf");
        link = leaf_link(static_cast<std::uint32_t>(first), count);
        next = first + count;
      }
    }
  }
  if (from.left() != 0) throw sim::InputError("tree: is longer than its nodes");
  check_depth(links);
  return links;
}

}  // namespace traces
