#include "tools/reproduce/outcome.h"

namespace tools::reproduce {

Samples samples_of(const Simulation& simulation, std::uint64_t pixels) {
  const std::uint64_t wanted = pixels * simulation.program.samples;
  return {.wanted = wanted, .traced = wanted};
}

}  // namespace tools::reproduce
