#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// The links between the nodes of a BVH, which determine the possible traversal walks of rays.
struct Links {
  std::vector<std::array<std::uint32_t, 2>> nodes;  ///< for each inner node, the link words of its children
  std::vector<std::uint32_t> roots;  ///< for each instance, the root of its tree or kNone; empty in trees of one level
  friend bool operator==(const Links&, const Links&) = default;
};

/// Largest depth of a BVH in a trace, which is also the number of stack entries per level.
inline constexpr std::uint32_t kMaxTreeDepth = 128;

Links links_of(const MemoryImage& image);

std::string encode_child_links(const Links& links);

/// Decodes a tree and checks it. Throws InputError unless all of these hold:
///
/// 1. Node 0 is a root. Every other inner node has one parent, with a lower number.
/// 2. The tree is no deeper than kMaxTreeDepth, and its leaves contain only triangles of the scene.
/// 3. With instances, it is a tree over instances with `counts.trees` trees below. Each leaf has one instance, no
///    instance appears twice, and each tree below belongs to an instance.
Links decode_child_links(std::string_view bytes, std::uint64_t nodes, const ImageCounts& counts);

}  // namespace traces
