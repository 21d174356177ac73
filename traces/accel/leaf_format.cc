#include "traces/accel/leaf_format.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>

#include <glm/geometric.hpp>

#include "traces/accel/record_bits.h"

namespace traces {
namespace {

using Vertex = std::array<std::uint32_t, 3>;  ///< the bits of a vertex

Vertex bits_of(const glm::vec3& v) {
  return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y), std::bit_cast<std::uint32_t>(v.z)};
}
std::array<Vertex, 3> vertices_of(const TriangleRecord& t) { return {bits_of(t.v0), bits_of(t.v1), bits_of(t.v2)}; }
glm::vec3 vertex_of(const Vertex& bits) {
  return {std::bit_cast<float>(bits[0]), std::bit_cast<float>(bits[1]), std::bit_cast<float>(bits[2])};
}

/// Different vertices of some triangles, and the place of each triangle's vertices among them.
struct VertexTable {
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  explicit VertexTable(std::span<const TriangleRecord> of) {
    for (const TriangleRecord& t : of) {
      auto& places = triangles.emplace_back();
      const auto corners = vertices_of(t);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto at = std::ranges::find(vertices, corners[i]);
        places[i] = static_cast<std::uint32_t>(at - vertices.begin());
        if (at == vertices.end()) vertices.push_back(corners[i]);
      }
    }
  }
};

/// How the vertices of a block are compressed.
struct BlockBits {
  std::uint32_t zeros = 0;                ///< trailing zeros of all coordinates
  std::array<std::uint32_t, 3> stored{};  ///< bits stored of each vertex, per axis
  std::uint32_t total = 0;

  explicit BlockBits(const VertexTable& table) {
    std::uint32_t any = 0;
    Vertex differ{};
    for (const Vertex& v : table.vertices) {
      for (std::size_t a = 0; a < 3; ++a) {
        any |= v[a];
        differ[a] |= v[a] ^ table.vertices[0][a];
      }
    }
    zeros = any == 0 ? 31 : static_cast<std::uint32_t>(std::countr_zero(any));
    total = 28 + 16 * static_cast<std::uint32_t>(table.triangles.size());
    for (std::size_t a = 0; a < 3; ++a) {
      const auto used = static_cast<std::uint32_t>(std::bit_width(differ[a]));
      stored[a] = std::max(used, zeros + 1) - zeros;
      total += 32 - zeros - stored[a];
      total += stored[a] * static_cast<std::uint32_t>(table.vertices.size());
    }
    if (table.vertices.size() > kMaxBlockVertices || table.triangles.size() > kMaxBlockTriangles) {
      total = std::numeric_limits<std::uint32_t>::max();
    }
  }
};

constexpr std::uint32_t flags_of(const TriangleRecord& t) { return t.material >> 28; }
constexpr std::uint32_t kFlagMask = 0xf0000000U;
static_assert((kAlphaFlag | kTintFlag | kNoClockwise | kNoCounterClockwise) == kFlagMask);

std::optional<std::vector<std::byte>> pack_pair(std::span<const TriangleRecord> triangles) {
  const bool pair = triangles.size() == 2;
  if (triangles.size() > 2 || (pair && !can_pair(triangles[0], triangles[1]))) return std::nullopt;
  const VertexTable table(triangles);
  std::vector<std::byte> record(64);
  RecordBitWriter to(record);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t a = 0; a < 3; ++a) to.put(i < table.vertices.size() ? table.vertices[i][a] : 0, 32);
  }
  to.put(triangles[0].object, 32);
  to.put(triangles[0].material, 32);
  to.put(triangles[0].source, 32);
  to.put(pair ? (triangles[1].source - triangles[0].source) & 0xffffU : 0, 16);
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t i = 0; i < 3; ++i) to.put(t < triangles.size() ? table.triangles[t][i] : 0, 2);
  }
  to.put(pair ? 1 : 0, 1);
  return record;
}

std::vector<TriangleRecord> unpack_pair(std::span<const std::byte> record) {
  RecordBitReader from(record);
  std::array<Vertex, 4> vertices;
  for (Vertex& v : vertices) {
    for (std::uint32_t& x : v) x = from.get(32);
  }
  TriangleRecord first{};
  first.object = from.get(32);
  first.material = from.get(32);
  first.source = from.get(32);
  const auto delta = static_cast<std::int16_t>(from.get(16));
  std::vector<TriangleRecord> triangles(2, first);
  triangles[1].source += static_cast<std::uint32_t>(std::int32_t{delta});
  for (TriangleRecord& t : triangles) {
    for (glm::vec3* v : {&t.v0, &t.v1, &t.v2}) *v = vertex_of(vertices[from.get(2)]);
  }
  if (from.get(1) == 0) triangles.pop_back();
  return triangles;
}

std::optional<std::vector<std::byte>> pack_block(std::span<const TriangleRecord> triangles) {
  const VertexTable table(triangles);
  const BlockBits bits(table);
  if (bits.total > kBlockBits) return std::nullopt;
  std::vector<std::byte> record(kBlockBits / 8);
  RecordBitWriter to(record);
  for (const std::uint32_t n : bits.stored) to.put(n - 1, 5);
  to.put(bits.zeros, 5);
  to.put(static_cast<std::uint32_t>(triangles.size()) - 1, 4);
  to.put(static_cast<std::uint32_t>(table.vertices.size()) - 1, 4);
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t below = bits.zeros + bits.stored[a];
    if (below < 32) to.put(table.vertices[0][a] >> below, 32 - below);
  }
  for (const Vertex& v : table.vertices) {
    for (std::size_t a = 0; a < 3; ++a) to.put(low_bits(v[a] >> bits.zeros, bits.stored[a]), bits.stored[a]);
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t place : table.triangles[t]) to.put(place, 4);
    to.put(flags_of(triangles[t]), 4);
  }
  return record;
}

std::vector<TriangleRecord> unpack_block(std::span<const std::byte> record) {
  RecordBitReader from(record);
  std::array<std::uint32_t, 3> stored{};
  for (std::uint32_t& n : stored) n = from.get(5) + 1;
  const std::uint32_t zeros = from.get(5);
  std::vector<TriangleRecord> triangles(from.get(4) + 1);
  std::vector<Vertex> vertices(from.get(4) + 1);
  std::array<std::uint32_t, 3> prefix{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t below = zeros + stored[a];
    prefix[a] = below < 32 ? from.get(32 - below) << below : 0;
  }
  for (Vertex& v : vertices) {
    for (std::size_t a = 0; a < 3; ++a) v[a] = prefix[a] | from.get(stored[a]) << zeros;
  }
  for (TriangleRecord& t : triangles) {
    for (glm::vec3* v : {&t.v0, &t.v1, &t.v2}) *v = vertex_of(vertices[from.get(4)]);
    t.object = t.source = 0;
    t.material = from.get(4) << 28;
  }
  return triangles;
}

double area_of(const TriangleRecord& a, const TriangleRecord& b) {
  Bounds box;
  for (const TriangleRecord* t : {&a, &b}) {
    for (const glm::vec3& v : {t->v0, t->v1, t->v2}) box.add(v);
  }
  const glm::dvec3 d = glm::dvec3(box.upper) - glm::dvec3(box.lower);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// The triangles of a leaf while they are sorted into records.
class LeafArranger {
 public:
  LeafArranger(std::span<const TriangleRecord> input, LeafFormat format) : input_(input), format_(format) {}

  /// Sorts the input indices of a leaf's triangles, and sets `begins` for each.
  void arrange(std::span<std::uint32_t> leaf, std::vector<bool>& begins, std::size_t first) {
    left_.assign(leaf.begin(), leaf.end());
    std::size_t at = 0;
    while (!left_.empty()) {
      format_ == LeafFormat::kPair64 ? take_pair() : take_block();
      for (std::size_t i = 0; i < record_.size(); ++i, ++at) {
        leaf[at] = record_[i];
        begins[first + at] = i == 0;
      }
    }
  }

 private:
  /// Moves the pair of smallest box from `left_` to `record_`, or a single triangle if none can be paired.
  void take_pair() {
    std::size_t first = 0, second = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < left_.size(); ++i) {
      for (std::size_t j = i + 1; j < left_.size(); ++j) {
        const TriangleRecord &a = input_[left_[i]], &b = input_[left_[j]];
        if (!can_pair(a, b) || area_of(a, b) >= least) continue;
        least = area_of(a, b);
        first = i;
        second = j;
      }
    }
    record_.assign(1, left_[first]);
    if (second != 0) {
      record_.push_back(left_[second]);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(second));
    }
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(first));
  }

  /// Moves triangles to a block: the first one left, then each time the triangle that takes the fewest bits.
  void take_block() {
    record_.assign(1, left_.front());
    left_.erase(left_.begin());
    std::vector<TriangleRecord> block{input_[record_[0]]};
    while (!left_.empty()) {
      std::uint32_t least = kBlockBits + 1;
      std::size_t best = 0;
      for (std::size_t i = 0; i < left_.size(); ++i) {
        block.push_back(input_[left_[i]]);
        const std::uint32_t bits = block_bits(block);
        block.pop_back();
        if (bits >= least) continue;
        least = bits;
        best = i;
      }
      if (least > kBlockBits) return;
      block.push_back(input_[left_[best]]);
      record_.push_back(left_[best]);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(best));
    }
  }

  const std::span<const TriangleRecord> input_;
  const LeafFormat format_;
  std::vector<std::uint32_t> left_, record_;
};

}  // namespace

std::uint32_t block_bits(std::span<const TriangleRecord> triangles) { return BlockBits(VertexTable(triangles)).total; }

bool can_pair(const TriangleRecord& a, const TriangleRecord& b) {
  const auto delta = static_cast<std::int64_t>(b.source) - static_cast<std::int64_t>(a.source);
  return a.object == b.object && a.material == b.material && delta == static_cast<std::int16_t>(delta) &&
         VertexTable(std::array{a, b}).vertices.size() <= 4;
}

std::optional<std::vector<std::byte>> pack_leaf_record(std::span<const TriangleRecord> triangles, LeafFormat format) {
  assert(!triangles.empty() && format != LeafFormat::kTriangles);
  return format == LeafFormat::kPair64 ? pack_pair(triangles) : pack_block(triangles);
}

std::vector<TriangleRecord> unpack_leaf_record(std::span<const std::byte> record, LeafFormat format) {
  return format == LeafFormat::kPair64 ? unpack_pair(record) : unpack_block(record);
}

void arrange_leaves(std::span<const TriangleRecord> input, std::span<const std::uint32_t> leaf_links, LeafFormat format,
                    std::vector<std::uint32_t>& order, std::vector<bool>& begins, std::uint32_t offset) {
  begins.resize(std::max(begins.size(), offset + order.size()));
  LeafArranger arranger(input, format);
  for (const std::uint32_t link : leaf_links) {
    const std::uint32_t first = leaf_first(link) - offset;
    arranger.arrange(std::span(order).subspan(first, leaf_count(link)), begins, leaf_first(link));
  }
}

void cut_records(std::span<const TriangleRecord> triangles, std::span<const std::uint32_t> leaf_links,
                 LeafFormat format, std::vector<bool>& begins) {
  const auto fits = [&](std::size_t first, std::size_t count) {
    const auto record = triangles.subspan(first, count);
    return format == LeafFormat::kPair64 ? count == 2 && can_pair(record[0], record[1])
                                         : block_bits(record) <= kBlockBits;
  };
  for (const std::uint32_t link : leaf_links) {
    std::size_t first = leaf_first(link);
    for (std::size_t i = first; i < leaf_first(link) + leaf_count(link); ++i) {
      begins[i] = i == first || !fits(first, i - first + 1);
      if (begins[i]) first = i;
    }
  }
}

std::vector<std::uint32_t> triangle_leaves(const MemoryImage& image, std::uint32_t first) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t node = first; node < image.node_count(); ++node) {
    for (const std::uint32_t link : image.links_of(node)) {
      if (is_leaf(link) && !is_instance(link)) leaves.push_back(link);
    }
  }
  return leaves;
}

}  // namespace traces
