#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/accel/memory_image.h"

namespace traces {

/// Of each inner node the link words of its children (memory_image.h): all of a tree that walks depend on.
using Links = std::vector<std::array<std::uint32_t, 2>>;

/// Deepest tree that a trace may have: entries of a full stack.
inline constexpr std::uint32_t kMaxTreeDepth = 128;

Links links_of(const MemoryImage& image);

std::string encode_links(const Links& links);

/// InputError unless this is a tree: node 0 is its root, every other inner node has one parent, of a lower number, it
/// is no deeper than kMaxTreeDepth, and leaves hold some of `triangles` triangles.
Links decode_links(std::string_view bytes, std::uint64_t nodes, std::uint64_t triangles);

}  // namespace traces
