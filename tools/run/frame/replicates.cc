#include "tools/run/frame/replicates.h"

#include <mutex>
#include <utility>

#include "tools/host/on_threads.h"
#include "tools/run/frame/machine_run.h"

namespace tools {
namespace {

/// Simulates recorded work on several machines concurrently.
class KeptWorkPlayer {
 public:
  KeptWorkPlayer(const Inputs& inputs, const kernels::FrameRequirements& requirements, const KeptWork& work,
        const FrameResult& plain, std::span<const Play> plays, const char* what, Progress* progress)
      : inputs_(inputs),
        requirements_(requirements),
        work_(work),
        plays_(plays),
        what_(what),
        progress_(progress),
        all_(plays.size(), plain) {
    for (FrameResult& s : all_) s.function.rgb = {}, s.function.marks = {};
    begin_part();
  }

  std::vector<FrameResult> play(std::uint32_t threads) {
    do_all(all_.size(), threads, [this](std::size_t i, std::size_t) { play_one(i); });
    return std::move(all_);
  }

 private:
  void play_one(std::size_t i) {
    KeptProgram program(work_, requirements_, [&] { tile_done(); });
    const NoTracer no_tracer;
    FrontEnd tiles(program, no_tracer, 0);
    const RunConfig& config = plays_[i].config;
    const auto gpu = make_gpu(inputs_, config, requirements_, tiles, plays_[i].perturbation, {}, plays_[i].scheduled);
    run_to_end(*gpu);
    all_[i].machine = config.gpu;
    take(*gpu, config, all_[i]);
  }
  void begin_part() {
    if (progress_ != nullptr) progress_->begin_part(what_, inputs_.frame, work_.tiles());
  }
  void tile_done() {
    const std::lock_guard lock(mutex_);
    tiles_done_ += 1;
    if (progress_ != nullptr) progress_->tiles_done(tiles_done_, 0, 0);
    if (tiles_done_ < work_.tiles()) return;
    tiles_done_ = 0;
    if (++parts_done_ < all_.size()) begin_part();
  }

  const Inputs& inputs_;
  const kernels::FrameRequirements& requirements_;
  const KeptWork& work_;
  const std::span<const Play> plays_;
  const char* const what_;
  Progress* const progress_;
  std::vector<FrameResult> all_;
  std::mutex mutex_;
  std::uint32_t tiles_done_ = 0,
                parts_done_ =
                    0;  ///< finished tiles of the current part, finished parts; a part has as many tiles as the frame
};

}  // namespace

std::vector<FrameResult> play_kept(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                   const KeptWork& work, const FrameResult& plain, std::span<const Play> plays,
                                   const char* what, std::uint32_t threads, Progress* progress) {
  return KeptWorkPlayer(inputs, requirements, work, plain, plays, what, progress).play(host_threads(threads));
}

std::vector<FrameResult> play_replicates(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                         const KeptWork& work, const FrameResult& plain, const hw::Gpu& gpu,
                                         std::uint32_t count, std::uint32_t threads, Progress* progress) {
  std::vector<Play> plays;
  for (std::uint32_t number = 1; number <= count; ++number) {
    plays.push_back(
        {inputs.config, hw::draw_perturbation(inputs.config.gpu->cores, inputs.frame, number), gpu.scheduled()});
  }
  return play_kept(inputs, requirements, work, plain, plays, "replicating", threads, progress);
}

}  // namespace tools
