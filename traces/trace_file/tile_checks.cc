#include "traces/trace_file/tile_checks.h"

#include <vector>

#include <fmt/format.h>

#include "sim/error.h"

namespace traces {

void check_rays(const WorkNode& rays, const TileWork& work) {
  if (rays.inputs.size() != 1 || rays.inputs[0].kind != Edge::Kind::kEach ||
      work.nodes[rays.inputs[0].node].kind != WorkNode::Kind::kLaunch) {
    throw sim::InputError("rays must have one input, an `each` edge from a launch");
  }
  if (rays.sources == WorkNode::kNone && rays.items != work.nodes[rays.inputs[0].node].items) {
    throw sim::InputError("rays without sources must be as many as the items that make them");
  }
}

bool has_slots(const WorkNode& node) {
  return node.kind == WorkNode::Kind::kRays || node.kind == WorkNode::Kind::kRaster;
}

void check_readers(const TileWork& work) {
  std::vector<bool> read(work.nodes.size()), whole(work.nodes.size());
  for (const WorkNode& node : work.nodes) {
    for (const Edge& edge : node.inputs) {
      const bool is_mapped = node.sources != WorkNode::kNone;
      read[edge.node] = true;
      if (edge.kind == Edge::Kind::kAll || is_mapped || node.items == work.nodes[edge.node].items)
        whole[edge.node] = true;
    }
  }
  for (std::size_t n = 0; n < work.nodes.size(); ++n) {
    if (!has_slots(work.nodes[n]) || whole[n]) continue;
    throw sim::InputError(fmt::format("no node reads {} hits of node {}", read[n] ? "all" : "the", n));
  }
}

void check_imports(const TileWork& work) {
  std::uint32_t read = 0;
  for (const WorkNode& node : work.nodes) {
    const bool imports = node.kind == WorkNode::Kind::kTransfer && !node.to_memory && node.border != WorkNode::kNone;
    if (imports) read |= 1U << node.border;
  }
  for (std::size_t i = 0; i < work.imports.size(); ++i) {
    if ((read >> i & 1U) == 0) throw sim::InputError(fmt::format("no transfer reads border {}", i));
  }
}

}  // namespace traces
