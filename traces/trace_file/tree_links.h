#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// The links between the nodes of a BVH, which determine the possible traversal walks of rays. `nodes` is empty if the
/// BVH is wide, and `wide_nodes` if not.
struct Links {
  std::vector<std::array<std::uint32_t, 2>> nodes;  ///< for each inner node, the link words of its children
  std::vector<std::uint32_t> roots;  ///< for each instance, the root of its tree or kNone; empty in trees of one level
  std::vector<std::array<std::uint32_t, kMaxWidth>> wide_nodes{};  ///< the same of each node of a wide tree
  std::uint32_t slots = 2;                                         ///< slots of a node that may have a child
  std::vector<bool> begins_record{};                               ///< as in MemoryImage
  friend bool operator==(const Links&, const Links&) = default;

  bool is_wide() const { return !wide_nodes.empty(); }
  std::size_t node_count() const { return is_wide() ? wide_nodes.size() : nodes.size(); }
  /// Returns the links of a node's slots.
  std::span<std::uint32_t> children_of(std::uint32_t node) {
    if (is_wide()) return std::span(wide_nodes[node]).first(slots);
    return nodes[node];
  }
  std::span<const std::uint32_t> children_of(std::uint32_t node) const {
    if (is_wide()) return std::span(wide_nodes[node]).first(slots);
    return nodes[node];
  }
};

/// Largest depth of a BVH in a trace. A ray's stack has an entry per level, in wide trees kMaxWidth - 1.
inline constexpr std::uint32_t kMaxTreeDepth = 128;

Links links_of(const MemoryImage& image);

/// Encodes the nodes and instances of a tree.
std::string encode_child_links(const Links& links);
/// Encodes where leaf records begin: one bit per triangle, lowest first.
std::string encode_records(const std::vector<bool>& begins_record);
/// Throws InputError unless `bytes` has one bit per triangle.
std::vector<bool> decode_records(std::string_view bytes, std::uint64_t triangles);

/// Decodes a tree and checks it. Throws InputError unless all of these hold:
///
/// 1. Node 0 is a root. Every other inner node has one parent, with a lower number.
/// 2. The tree is no deeper than kMaxTreeDepth, and its leaves contain only triangles of the scene.
/// 3. With instances, it is a tree over instances with `counts.trees` trees below. Each leaf has one instance, no
///    instance appears twice, and each tree below belongs to an instance.
/// 4. Every node but a root has two children or more.
/// 5. The leaves of a wide tree have as many triangles as the scene.
///
/// `slots`: number of slots of each node of a wide tree, or 0 for a binary tree.
Links decode_child_links(std::string_view bytes, std::uint64_t nodes, const ImageCounts& counts,
                         std::uint32_t slots = 0);

}  // namespace traces
