#include "hw_models/frame/tile_lines.h"
#include "hw_models/machines/gpu.h"

namespace hw {

void Gpu::warm(const traces::TileWork& work, std::uint32_t core) {
  const Core& c = cores_[core];
  const std::vector<Trv*>& trvs = c.tni.trvs();
  const Interleave banks = config_.l2.interleave();
  const auto second_level = [&](Addr line) { memory_.banks()[banks.owner(line)]->warm(line); };
  for_each_line(
      work, layout_,
      [&](std::uint32_t ray, Addr line) {
        if (!trvs[ray % trvs.size()]->warm(line)) second_level(line);
      },
      [&](Addr line) {
        if (!c.tni.ist().warm(line)) second_level(line);
      },
      [&](Addr line) {
        if (!c.srp->warm(line)) second_level(line);
      });
}

}  // namespace hw
