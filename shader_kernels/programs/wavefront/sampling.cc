#include "shader_kernels/programs/wavefront/sampling.h"

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
  for (std::size_t check = 0; check < failed.size(); ++check) first_failed[check] += other.first_failed[check];
  rough += other.rough;
  for (std::size_t count = 0; count < active.size(); ++count) active[count] += other.active[count];
  for (std::size_t reason = 0; reason < reasons.size(); ++reason) reasons[reason] += other.reasons[reason];
  for (std::size_t reason = 0; reason < reasons.size(); ++reason) first_reasons[reason] += other.first_reasons[reason];
  padding += other.padding;
  propagated += other.propagated;
}

}  // namespace kernels
