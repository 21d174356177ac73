#pragma once
#include <cstdint>
#include <vector>

#include "tools/simulation/kept_work.h"
#include "tools/simulation/run_job.h"

namespace tools {

/// Plays kept work on `count` perturbed machines, as many at once as there are threads, and returns what each did in
/// the order of their numbers, which begin at 1. `plain`: the run of the same work on a machine that was not perturbed.
/// Whatever ends one ends all: sim::Deadlock, Interrupted.
std::vector<Simulation> play_replicates(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                        const KeptWork& work, const Simulation& plain, std::uint32_t count,
                                        std::uint32_t threads, Progress* progress);

}  // namespace tools
