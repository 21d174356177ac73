#include "hw_models/machines/perturbation.h"

#include "sim/hash.h"

namespace hw {
namespace {

constexpr std::uint32_t kStarts = 8;   // a core starts up to seven cycles late
constexpr std::uint32_t kFabrics = 3;  // a cycle less, none, a cycle more

}  // namespace

Perturbation draw_perturbation(std::uint32_t cores, std::uint32_t frame, std::uint32_t replicate) {
  Perturbation drawn;
  if (replicate == 0) return drawn;
  for (std::uint32_t core = 0; core < cores; ++core) {
    drawn.starts.push_back(static_cast<std::uint32_t>(sim::hash(frame, replicate, 1, core) % kStarts));
  }
  drawn.dram.fabric = static_cast<std::int32_t>(sim::hash(frame, replicate, 2) % kFabrics) - 1;
  drawn.dram.refresh = static_cast<std::uint32_t>(sim::hash(frame, replicate, 3));
  return drawn;
}

}  // namespace hw
