#include "shader_kernels/programs/wavefront/tile_result.h"

#include <algorithm>

#include <glm/common.hpp>

namespace kernels {
glm::vec3 TileResult::averaged_colour(std::uint32_t sample) const {
  const Vec3<float>& rgb = buffer.samples.colours[sample].rgb;
  return glm::clamp(glm::vec3(rgb.x, rgb.y, rgb.z), 0.0F, 1.0F);
}

void TileSummaries::add(const TileResult& tile) {
  TileSummary sum{.tile = tile.tile,
                  .x = tile.x,
                  .y = tile.y,
                  .width = tile.width,
                  .height = tile.height,
                  .begins_pass = tile.work.after_all,
                  .rays = tile.rays,
                  .steps = tile.traversal_steps,
                  .tests = tile.triangle_tests,
                  .accesses = tile.work.accesses.size()};
  const auto first = static_cast<std::ptrdiff_t>(kernels.size());
  for (const traces::WorkNode& node : tile.work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kTransfer) sum.transfer_bytes += node.items;
    if (node.kind != traces::WorkNode::Kind::kLaunch) continue;
    const auto known = std::find_if(kernels.begin() + first, kernels.end(),
                                    [&](const KernelItems& k) { return k.kernel == node.kernel; });
    if (known == kernels.end()) {
      kernels.push_back({node.kernel, node.items + node.idle});
    } else {
      known->items += node.items + node.idle;
    }
  }
  sum.kernels = kernels.size();
  tiles.push_back(sum);
}

}  // namespace kernels
