#include "shader_kernels/programs/sampling.h"

namespace kernels {

void Sampling::add(const Sampling& other) {
  wanted += other.wanted;
  traced += other.traced;
  halo += other.halo;
  correction += other.correction;
  background += other.background;
  traced_background += other.traced_background;
  checked += other.checked;
  passed += other.passed;
  for (std::size_t check = 0; check < failed.size(); ++check) failed[check] += other.failed[check];
}

}  // namespace kernels
