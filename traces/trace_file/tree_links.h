#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// All of a tree that walks depend on.
struct Links {
  std::vector<std::array<std::uint32_t, 2>> nodes;  ///< link words of the children of each inner node
  std::vector<std::uint32_t> roots;  ///< the root of each instance's tree, or kNone; empty in trees of one level
  friend bool operator==(const Links&, const Links&) = default;
};

/// Deepest tree that a trace may have: entries of a full stack, of each level.
inline constexpr std::uint32_t kMaxTreeDepth = 128;

Links links_of(const MemoryImage& image);

std::string encode_links(const Links& links);

/// InputError unless this is a tree: node 0 is its root, every other inner node has one parent, of a lower number, it
/// is no deeper than kMaxTreeDepth, and leaves hold some of the triangles. With instances, it is a tree of them and
/// `counts.trees` such trees below: its leaves hold one instance each, none twice, and all trees have instances.
Links decode_links(std::string_view bytes, std::uint64_t nodes, const ImageCounts& counts);

}  // namespace traces
