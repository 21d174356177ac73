#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "traces/accel/memory_image.h"
#include "traces/stream.h"

namespace hw {

/// The cache lines that a memory access of a kernel reads, given the accessed element and the memory layout.
struct LineSet {
  Addr line[4];
  std::uint32_t count = 0;

  void add_line_of(Addr address) {
    const Addr wanted = line_of(address);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (line[i] == wanted) return;
    }
    line[count++] = wanted;
  }
};

/// Returns the lines of an access. `stored`: address of region kSamples.
inline LineSet lines_of_access(const traces::Access& access, const traces::Layout& layout, Addr stored = 0) {
  LineSet lines;
  switch (access.kind()) {
    case traces::Access::Kind::kAttributes:
      lines.add_line_of(layout.attributes_at(access.element));
      break;
    case traces::Access::Kind::kMaterial:
      lines.add_line_of(layout.material_at(access.element));
      break;
    case traces::Access::Kind::kVertices:
      lines.add_line_of(layout.vertices_at(access.element));
      break;
    case traces::Access::Kind::kDetail:
      lines.add_line_of(layout.detail_at(access.element));
      break;
    case traces::Access::Kind::kTriangle:
      lines.add_line_of(layout.triangle_at(access.element));
      lines.add_line_of(layout.triangle_at(access.element) + layout.triangle_bytes - 1);
      if (layout.has_labels()) {
        lines.add_line_of(layout.label_at(access.element));
        lines.add_line_of(layout.label_at(access.element) + traces::Layout::kLabelBytes - 1);
      }
      break;
    case traces::Access::Kind::kInstance:
      lines.add_line_of(layout.instance_at(access.element));
      break;
    case traces::Access::Kind::kStored:  // a record of several lines has an access per line
      lines.add_line_of(stored + Addr{access.element} * traces::kStoredWordBytes);
      break;
    case traces::Access::Kind::kTexels: {
      const std::uint32_t xs[2] = {access.element & 0xffffU, access.element2 & 0xffffU};
      const std::uint32_t ys[2] = {access.element >> 16, access.element2 >> 16};
      for (const std::uint32_t y : ys) {
        for (const std::uint32_t x : xs) lines.add_line_of(layout.texel_tile_at(access.texture(), x, y));
      }
      break;
    }
  }
  return lines;
}

}  // namespace hw
