#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "tools/run/frame/kept_work.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// A machine that simulates recorded work.
struct Play {
  RunConfig config;
  hw::Perturbation perturbation;
  std::shared_ptr<const hw::ScheduledKernels> scheduled{};  ///< kernel schedules of its shader cores; null: computed
};

/// Simulates recorded work on several machines, `threads` at a time, and returns their results in order. `plain`:
/// results that are equal for all. `what`: name in the progress. An exception of one machine ends all: sim::Deadlock,
/// Interrupted.
std::vector<FrameResult> play_kept(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                   const KeptWork& work, const FrameResult& plain, std::span<const Play> plays,
                                   const char* what, std::uint32_t threads, Progress* progress);

/// The same on `count` machines with perturbations 1 to `count`. `plain`: result of the unperturbed machine `gpu`.
std::vector<FrameResult> play_replicates(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                         const KeptWork& work, const FrameResult& plain, const hw::Gpu& gpu,
                                         std::uint32_t count, std::uint32_t threads, Progress* progress);

}  // namespace tools
