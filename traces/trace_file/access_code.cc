#include "traces/trace_file/access_code.h"

#include <algorithm>

namespace traces {
namespace {

/// For each access of an item, counts how many accesses of its kind came before it.
class AccessRanks {
 public:
  std::uint32_t next_rank(std::uint32_t kind) { return seen_[kind]++; }

 private:
  std::array<std::uint32_t, kAccessKinds> seen_{};
};

std::uint64_t record_count(const AccessLimits& limits, Access::Kind kind) {
  const ImageCounts& counts = limits.counts;
  switch (kind) {
    case Access::Kind::kAttributes:
      return counts.attributes;
    case Access::Kind::kMaterial:
      return counts.materials;
    case Access::Kind::kVertices:
      return counts.vertices;
    case Access::Kind::kDetail:
      return counts.details;
    case Access::Kind::kTriangle:
      return counts.triangles;
    case Access::Kind::kInstance:
      return counts.instances;
    case Access::Kind::kStored:
      return limits.stored_words;
    case Access::Kind::kTexels:
      break;
  }
  return 0;
}

constexpr std::uint32_t corner_x(std::uint32_t corner) { return corner & 0xffffU; }
constexpr std::uint32_t corner_y(std::uint32_t corner) { return corner >> 16; }
constexpr std::int64_t signed_difference(std::uint32_t a, std::uint32_t b) { return std::int64_t{a} - std::int64_t{b}; }

}  // namespace

void AccessWriter::write_access(const Access& access, std::uint32_t rank, ByteWriter& to) {
  Access& last = last_.of[static_cast<std::size_t>(access.kind())][rank];
  if (access.kind() == Access::Kind::kTexels) {
    to.write_difference(signed_difference(access.texture(), last.texture()));
    to.write_difference(signed_difference(corner_x(access.element), corner_x(last.element)));
    to.write_difference(signed_difference(corner_y(access.element), corner_y(last.element)));
    to.write_difference(signed_difference(corner_x(access.element2), corner_x(access.element)));
    to.write_difference(signed_difference(corner_y(access.element2), corner_y(access.element)));
  } else {
    to.write_difference(signed_difference(access.element, last.element));
  }
  last = access;
}

void AccessWriter::write_launch(const TileWork& work, const WorkNode& launch, std::string& out) {
  shapes_.clear();
  shape_of_.clear();
  const auto begin_of = [&](std::uint32_t item) { return work.access_begin[launch.first + item]; };
  std::vector<std::uint8_t> shape;
  for (std::uint32_t item = 0; item < launch.items; ++item) {
    shape.clear();
    for (std::uint32_t a = begin_of(item); a < begin_of(item + 1); ++a) {
      shape.push_back(static_cast<std::uint8_t>(work.accesses[a].kind()));
    }
    // Fast path: most items access memory in the same pattern as the previous one.
    if (item == 0 || shape != shapes_[shape_of_.back()]) {
      const auto found = std::ranges::find(shapes_, shape);
      shape_of_.push_back(static_cast<std::uint32_t>(found - shapes_.begin()));
      if (found == shapes_.end()) shapes_.push_back(shape);
    } else {
      shape_of_.push_back(shape_of_.back());
    }
    if (shape.size() > kMaxItemAccesses || shapes_.size() > kMaxShapes) {
      throw sim::InputError(
          "an item with more than 64 accesses, or more than 4096 kinds of items in a launch, cannot "
          "be recorded");
    }
  }
  ByteWriter to(out);
  to.write_number(shapes_.size());
  for (const auto& kinds : shapes_) {
    to.write_number(kinds.size());
    for (const std::uint8_t kind : kinds) to.write_byte(kind);
  }
  if (shapes_.size() > 1) {
    for (const std::uint32_t s : shape_of_) to.write_number(s);
  }
  for (std::uint32_t item = 0; item < launch.items; ++item) {
    AccessRanks ranks;
    for (std::uint32_t a = begin_of(item); a < begin_of(item + 1); ++a) {
      write_access(work.accesses[a], ranks.next_rank(static_cast<std::uint32_t>(work.accesses[a].kind())), to);
    }
  }
}

void AccessReader::read_shapes(ByteReader& from) {
  const std::uint32_t shapes = from.read_number32(kMaxShapes, "number of shapes");
  if (shapes == 0) ByteReader::throw_out_of_range("number of shapes");
  kinds_.clear();
  ranks_.clear();
  shape_begin_.assign(1, 0);
  for (std::uint32_t s = 0; s < shapes; ++s) {
    AccessRanks ranks;
    for (std::uint32_t left = from.read_number32(kMaxItemAccesses, "accesses of an item"); left > 0; --left) {
      const std::uint32_t kind = from.read_byte();
      if (kind >= kAccessKinds) ByteReader::throw_out_of_range("kind of an access");
      kinds_.push_back(static_cast<std::uint8_t>(kind));
      ranks_.push_back(static_cast<std::uint8_t>(ranks.next_rank(kind)));
    }
    shape_begin_.push_back(static_cast<std::uint32_t>(kinds_.size()));
  }
}

Access AccessReader::read_access(ByteReader& from, const AccessLimits& limits, std::uint32_t kind, std::uint32_t rank) {
  Access& last = last_.of[kind][rank];
  if (static_cast<Access::Kind>(kind) != Access::Kind::kTexels) {
    const std::uint64_t count = record_count(limits, static_cast<Access::Kind>(kind));
    if (count == 0) ByteReader::throw_out_of_range("an accessed record");
    last = Access::of_kind(static_cast<Access::Kind>(kind),
                           from.read_difference_from(last.element, count - 1, "an accessed record"));
    return last;
  }
  const ImageCounts& counts = limits.counts;
  if (counts.textures.empty()) ByteReader::throw_out_of_range("an accessed texture");
  const std::uint32_t texture =
      from.read_difference_from(last.texture(), counts.textures.size() - 1, "an accessed texture");
  const auto [width, height] = counts.textures[texture];
  const std::uint32_t x0 = from.read_difference_from(corner_x(last.element), width - 1, "an accessed texel");
  const std::uint32_t y0 = from.read_difference_from(corner_y(last.element), height - 1, "an accessed texel");
  const std::uint32_t x1 = from.read_difference_from(x0, width - 1, "an accessed texel");
  const std::uint32_t y1 = from.read_difference_from(y0, height - 1, "an accessed texel");
  last = Access::texels(texture, x0, y0, x1, y1);
  return last;
}

void AccessReader::read_launch(ByteReader& from, const AccessLimits& limits, std::uint32_t items, TileWork& work) {
  read_shapes(from);
  const std::uint32_t shapes = static_cast<std::uint32_t>(shape_begin_.size()) - 1;
  shape_of_.clear();
  if (shapes > 1) {
    if (items > from.bytes_left()) ByteReader::throw_out_of_range("number of items");
    for (std::uint32_t item = 0; item < items; ++item) shape_of_.push_back(from.read_number32(shapes - 1, "a shape"));
  } else if (shape_begin_.back() > 0 && items > from.bytes_left()) {
    ByteReader::throw_out_of_range("number of items");
  }
  for (std::uint32_t item = 0; item < items; ++item) {
    const std::uint32_t shape = shapes > 1 ? shape_of_[item] : 0;
    work.access_begin.push_back(static_cast<std::uint32_t>(work.accesses.size()));
    for (std::uint32_t a = shape_begin_[shape]; a < shape_begin_[shape + 1]; ++a) {
      work.accesses.push_back(read_access(from, limits, kinds_[a], ranks_[a]));
    }
  }
}

}  // namespace traces
