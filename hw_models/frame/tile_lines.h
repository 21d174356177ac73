#pragma once
#include <cstdint>

#include "hw_models/srp/data_cache.h"
#include "hw_models/tni/tree_in_memory.h"
#include "traces/stream.h"
#include "traces/walk.h"

namespace hw {

/// Returns the memory layout of the BVH, as read by a traversal unit with two box testers. Parent links, which only
/// prefetching needs, are left out.
inline TreeInMemory tree_from_layout(const traces::Layout& layout) {
  return {.nodes = layout.nodes,
          .node_bytes = layout.node_bytes,
          .single_boxes = layout.single_boxes,
          .instances = layout.instances,
          .instance_places = layout.instance_places};
}

/// Calls node(ray, line), triangle(ray, line) or data(line) for every cache line that a tile reads: first for the
/// tile's rays, then for its kernels. A simulated machine reads the lines in another order. `stored`: address of region
/// kSamples.
template <class Node, class Triangle, class Data>
void for_each_line_of_tile(const traces::TileWork& work, const traces::Layout& layout, Addr stored, Node&& node,
                           Triangle&& triangle, Data&& data) {
  const TreeInMemory tree = tree_from_layout(layout);
  const bool node_is_line = tree.has_one_line_per_node();
  for (std::uint32_t ray = 0; ray < work.ray_begin.size(); ++ray) {
    for (const std::uint32_t* step = &work.walk[work.ray_begin[ray]];; ++step) {
      const traces::StepKind kind = traces::kind_of(*step);
      if (traces::is_wide(*step)) {
        const Addr begin = layout.node_at(traces::node_of(*step));
        for (Addr line = line_of(begin); line < begin + layout.node_bytes; line += kLineBytes) node(ray, line);
        ++step;  // skips the word of hits
      } else if (kind == traces::StepKind::kVisit) {
        if (node_is_line) {
          node(ray, tree.line_of_node(traces::node_of(*step)));
          continue;
        }
        for (std::uint32_t i = 0;; ++i) {
          const TreeInMemory::Line line = tree.line_of_visit(traces::node_of(*step), 2, 0, i);
          node(ray, line.line);
          if (line.last) break;
        }
      } else if (traces::is_enter(*step)) {
        node(ray, tree.line_of_instance(traces::instance_index_of(*step)));
      } else if (kind == traces::StepKind::kLeaf) {
        const std::uint32_t first = traces::first_of(*step), count = traces::count_of(*step);
        const Addr end = layout.triangle_at(first + count - 1) + layout.triangle_bytes;
        for (Addr line = line_of(layout.triangle_at(first)); line < end; line += kLineBytes) triangle(ray, line);
        ++step;
      } else if (kind == traces::StepKind::kEnd) {
        break;
      }
    }
  }
  for (const traces::Access& access : work.accesses) {
    const LineSet lines = lines_of_access(access, layout, stored);
    for (std::uint32_t i = 0; i < lines.count; ++i) data(lines.line[i]);
  }
}

}  // namespace hw
