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

}  // namespace hw
