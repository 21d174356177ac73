#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "traces/accel/memory_image.h"
#include "traces/accel/node_format.h"

namespace traces {

// Leaf records of several triangles (BvhConfig::leaf).
//
// pair64, 64 bytes: up to two triangles that share an edge.
//   words 0 to 11   four vertices
//   words 12 to 14  object, material, source of the first triangle
//   word 15         source of the second less the first (16, signed) | vertices of both triangles (12) | pair (1)
// Both triangles have the same object and material.
//
// block128, 1024 bits: up to 16 triangles of up to 16 vertices; labels are apart, as with 36-byte triangles.
//   28     bits per coordinate less one, x, y, z (5 each) | trailing zeros (5) | triangles less one (4) | vertices less
//          one (4)
//   rest   leading bits of x, y, z, which all vertices share; vertices; per triangle 3 x 4 bits of vertex, 4 bits flags
//
// 1. Vertices keep all bits: only leading bits and trailing zeros that all have in common are dropped.
// 2. A triangle keeps the order of its vertices, so the triangle test gives the same bits.
// 3. The triangles of a record are consecutive and of one leaf.

inline constexpr std::uint32_t kBlockBits = 1024, kMaxBlockTriangles = 16, kMaxBlockVertices = 16;

/// Returns the bits that a block of these triangles takes; more than kBlockBits if they do not fit.
std::uint32_t block_bits(std::span<const TriangleRecord> triangles);
/// True if a pair64 record can contain both triangles.
bool can_pair(const TriangleRecord& a, const TriangleRecord& b);

/// Packs triangles into the bytes of a record, or returns none if they do not fit. The inverses give back vertices and,
/// for a pair, labels; for a block the flags of the material.
std::optional<std::vector<std::byte>> pack_leaf_record(std::span<const TriangleRecord> triangles, LeafFormat format);
std::vector<TriangleRecord> unpack_leaf_record(std::span<const std::byte> record, LeafFormat format);

/// Sorts the triangles of leaves so that those of a record are consecutive. `order` has the indices in `input` of a
/// tree's triangles, in leaf order; the first has number `offset` in the image. `begins` gets, for each triangle of the
/// image in the new order, whether a record begins with it.
void arrange_leaves(std::span<const TriangleRecord> input, std::span<const std::uint32_t> leaf_links, LeafFormat format,
                    std::vector<std::uint32_t>& order, std::vector<bool>& begins, std::uint32_t offset = 0);

/// Splits the triangles of leaves into records again after they have moved; their order stays.
void cut_records(std::span<const TriangleRecord> triangles, std::span<const std::uint32_t> leaf_links,
                 LeafFormat format, std::vector<bool>& begins);

/// Returns the links to leaves of triangles of the nodes from `first` on, in node order.
std::vector<std::uint32_t> triangle_leaves(const MemoryImage& image, std::uint32_t first = 0);

}  // namespace traces
