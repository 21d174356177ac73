#include "hw_models/tni/tree_in_memory.h"

#include <algorithm>
#include <cassert>

namespace hw {

TreeInMemory::Line TreeInMemory::line_of_visit(std::uint32_t node, std::uint32_t testers, std::uint32_t child,
                                               std::uint32_t index) const {
  std::array<Addr, 4> lines{};
  std::uint32_t count = 0;
  const auto add = [&](Addr byte) {
    const Addr line = hw::line_of(byte);
    if (std::find(lines.begin(), lines.begin() + count, line) == lines.begin() + count) lines[count++] = line;
  };
  const auto add_record = [&](std::uint32_t record) {
    const Addr begin = nodes + Addr{record} * node_bytes;
    add(begin);
    add(begin + node_bytes - 1);
  };
  if (single_boxes.empty()) {
    add_record(node);
  } else if (testers == 1) {
    add_record(single_boxes[node][child]);
  } else {
    for (const std::uint32_t record : single_boxes[node]) add_record(record);
  }
  assert(index < count);
  return {lines[index], index + 1 == count};
}

namespace {

/// Returns the records of all wide nodes. An empty result: the nodes are binary.
std::shared_ptr<const std::vector<WideRecord>> wide_records(const traces::MemoryImage& image) {
  auto records = std::make_shared<std::vector<WideRecord>>();
  records->reserve(image.wide_nodes.size());
  for (std::uint32_t node = 0; node < image.wide_nodes.size(); ++node) {
    const Addr begin = image.layout.node_at(node) - image.layout.nodes;
    const Addr first = begin / kLineBytes, last = (begin + image.layout.node_bytes - 1) / kLineBytes;
    const auto& links = image.wide_nodes[node].child;
    const auto children = std::ranges::count_if(links, [](std::uint32_t link) { return link != traces::kNoChild; });
    records->push_back({static_cast<std::uint32_t>(first), static_cast<std::uint8_t>(last - first + 1),
                        static_cast<std::uint8_t>(children)});
  }
  return records;
}

bool has_parents_in_nodes(const traces::MemoryImage& image) {
  return image.is_wide() && image.wide_format == traces::NodeFormat::kQ12;
}

}  // namespace

TreeKind tree_kind(const traces::MemoryImage& image) {
  const bool wide = image.is_wide();
  const traces::NodeFormat binary = image.grid ? traces::NodeFormat::kHybrid : traces::NodeFormat::kFp32;
  return {.wide = wide,
          .format = wide ? image.wide_format : binary,
          .slots = wide ? image.wide_slots() : 2,
          .order = image.child_order,
          .leaf = image.leaf_format};
}

TreeInMemory tree_in_memory(const traces::MemoryImage& image, std::span<const std::uint32_t> parents) {
  const traces::Layout& layout = image.layout;
  TreeInMemory tree{.nodes = layout.nodes,
                    .node_bytes = layout.node_bytes,
                    .parents = parents,
                    .single_boxes = layout.single_boxes,
                    .hybrid = image.grid.has_value(),
                    .links = image.nodes,
                    .instances = layout.instances,
                    .placed = image.instances,
                    .instance_places = layout.instance_places,
                    .kind = tree_kind(image),
                    .wide_links = image.wide_nodes,
                    .parent_links = layout.end,
                    .parents_in_nodes = has_parents_in_nodes(image)};
  if (image.is_wide()) {
    tree.wide = wide_records(image);
    tree.wide_nodes_have_lines =
        std::ranges::any_of(*tree.wide, [](const WideRecord& record) { return record.lines > 1; });
  }
  return tree;
}

void TrianglesInMemory::append_leaf_lines(std::uint32_t first, std::uint32_t count, std::vector<Addr>& lines) const {
  for (std::uint32_t triangle = first; triangle < first + count; ++triangle) {
    const Addr begin = record_of(triangle);
    for (Addr line = hw::line_of(begin); line < begin + bytes; line += kLineBytes) {
      if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
    }
  }
}

std::uint64_t tree_table_bytes(const traces::MemoryImage& image, const TrvConfig& config) {
  const std::uint64_t parents =
      TreeInMemory::parent_table_bytes(image.node_count(), has_parents_in_nodes(image), config.stack);
  if (config.prefetch != Prefetch::kTreelet) return parents;
  // An entry, a link and an end of list for each node, and a link for each leaf (there are at most as many leaves as
  // triangles). Alignment loses a line.
  const std::uint64_t words = 3 * std::uint64_t{image.node_count()} + image.triangles.size();
  return parents + words * sizeof(std::uint32_t) + kLineBytes;
}

}  // namespace hw
