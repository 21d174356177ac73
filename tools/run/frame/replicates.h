#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "tools/run/frame/kept_work.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// A machine that plays kept work.
struct Play {
  RunConfig config;
  hw::Perturbation perturbation;
  std::shared_ptr<const hw::ScheduledKernels> scheduled{};  ///< kernels on its shader cores; null: found anew
};

/// Plays kept work on machines, as many at once as there are threads, and returns what each did in their order.
/// `plain`: what is known of all of them before. `what`: it is called so in the progress. Whatever ends one ends all:
/// sim::Deadlock, Interrupted.
std::vector<FrameResult> play_kept(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                   const KeptWork& work, const FrameResult& plain, std::span<const Play> plays,
                                   const char* what, std::uint32_t threads, Progress* progress);

/// The same on `count` perturbed machines, in the order of their numbers, which begin at 1. `plain`: the run of the
/// same work on `gpu`, which was not perturbed.
std::vector<FrameResult> play_replicates(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                         const KeptWork& work, const FrameResult& plain, const hw::Gpu& gpu,
                                         std::uint32_t count, std::uint32_t threads, Progress* progress);

}  // namespace tools
