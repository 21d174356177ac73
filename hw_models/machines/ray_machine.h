#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "hw_models/frame/direct_interface_config.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/machines/memory_system.h"
#include "hw_models/tni/tni_core.h"
#include "sim/machine.h"
#include "sim/unit_report.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/memory_image.h"
#include "traces/ray_key.h"

namespace hw {

/// Replaces the shader core: sends a ray to the T&I unit every `interval` cycles if the link has room, and accepts each
/// hit at once.
///
/// `Rays` provides numbered rays through `ray_count()`, `ray_walk(ray)` and `ray_key(ray)`. For each finished ray,
/// `Rays::record_return_time(ray, now)` is called.
template <class Rays>
class RaySource {
 public:
  RaySource(sim::Clock clock, std::uint32_t interval, Rays& rays, sim::Link<RayJob>& rays_out,
            sim::Link<RayDone>& hits_in)
      : clock_(clock), interval_(interval), rays_(rays), out_(rays_out), in_(hits_in) {}

  const sim::Clock& clock() const { return clock_; }
  sim::Time tick(sim::Time now) {
    if (in_.can_pop(now)) {
      rays_.record_return_time(in_.pop(now).id, now);
      returned_ += 1;
    }
    if (sent_ < rays_.ray_count() && now >= send_at_ && out_.can_push(now)) {
      out_.push(now, {rays_.ray_walk(sent_), sent_, kNoTile, rays_.ray_key(sent_)});
      sent_ += 1;
      send_at_ = clock_.edge_after(now, interval_);
    }
    const sim::Time next = clock_.edge_after(now, 1);
    const sim::Time send = sent_ < rays_.ray_count() ? std::max({next, send_at_, out_.push_at()}) : sim::kNever;
    return std::min(send, std::max(next, in_.pop_at()));
  }
  bool is_done() const { return returned_ == rays_.ray_count(); }

 private:
  const sim::Clock clock_;
  const std::uint32_t interval_;
  Rays& rays_;
  sim::Link<RayJob>& out_;
  sim::Link<RayDone>& in_;
  std::uint32_t sent_ = 0, returned_ = 0;
  sim::Time send_at_ = 0;
};

/// Builds the T&I unit of a core and a source of rays that replaces the shader core. Returns the source.
///
///   source --> direct interface --> T&I unit --> memory
template <class Rays>
RaySource<Rays>& build_source_and_tni(sim::Machine& machine, const DirectInterfaceConfig& direct, sim::UnitId source,
                                      Rays& rays, TniCore& tni, const TniCore::Scene& scene,
                                      std::span<const MemoryPort> memory) {
  auto& jobs = machine.link<RayJob>(direct.depth, 1, source, tni.rays_in_id());
  auto& dones = machine.link<RayDone>(direct.depth, 1, tni.dispatcher_id(), source);
  auto& built = machine.build<RaySource<Rays>>(source, source.clock, direct.interval, rays, jobs, dones);
  tni.build_units(machine, scene, direct.interval, {jobs, dones, memory});
  return built;
}

/// The rays of a list that one of n cores traverses: every nth block of kBlock rays. The functional tracer traces a
/// block when it is first needed. The block is dropped when all its rays have returned.
class CoreRays {
 public:
  static constexpr std::uint32_t kBlock = 64;
  /// Callback for each finished block of rays, with the block's number of rays. If the callback returns false, the core
  /// starts no further block.
  using BlockCallback = std::function<bool(std::uint32_t rays, sim::Time now)>;

  /// `keys`: computes the rays' sort keys.
  CoreRays(std::span<const traces::Ray> rays, traces::RayKind kind, const traces::Tracer& tracer,
           const traces::RayKeyGrid& keys, std::uint32_t core, std::uint32_t core_count, BlockCallback finished);

  std::uint32_t ray_count() const { return count_; }
  const std::uint32_t* ray_walk(std::uint32_t ray);
  std::uint32_t ray_key(std::uint32_t ray) const;
  void record_return_time(std::uint32_t ray, sim::Time now);
  std::uint64_t hit_count() const { return hits_; }
  std::uint64_t step_count() const { return steps_; }

 private:
  struct Block {
    std::vector<std::uint32_t> words, begin;
    std::uint32_t left = 0;
  };
  std::span<const traces::Ray> rays_of_block(std::uint32_t block) const;
  void trace_next_block();

  const std::span<const traces::Ray> rays_;
  const traces::RayKind kind_;
  const traces::Tracer& tracer_;
  const traces::RayKeyGrid keys_;
  const std::uint32_t core_, cores_;
  const BlockCallback finished_;
  std::uint32_t count_ = 0;
  std::uint32_t first_ = 0;  ///< number of the block at the front of `blocks_`
  std::deque<Block> blocks_;
  std::vector<Block> spare_;
  std::vector<traces::Hit> hit_;
  std::uint64_t hits_ = 0, steps_ = 0;
};

/// Progress of the traversal of a list of rays.
struct RayProgress {
  std::uint32_t blocks = 0;  ///< number of finished blocks of CoreRays::kBlock rays
  std::uint64_t rays = 0, cycles = 0;
};

/// A GPU without shader cores, whose T&I units traverse a given list of rays through the GPU's caches and memory.
///
///   rays --> T&I unit of each core --> core port --> L2 banks --> channels
class RayMachine {
 public:
  /// Callback for each finished block of rays. If the callback returns false, only the blocks already started are
  /// finished.
  using ProgressCallback = std::function<bool(const RayProgress& so_far)>;

  /// `parents`: parent node of each node of the image's BVH. `kind`: shadow rays end at their first hit. All arguments
  /// must outlive the machine.
  RayMachine(const GpuConfig& config, const traces::MemoryImage& image, std::span<const std::uint32_t> parents,
             std::span<const traces::Ray> rays, traces::RayKind kind, ProgressCallback watch);
  RayMachine(const RayMachine&) = delete;
  RayMachine& operator=(const RayMachine&) = delete;

  /// Traverses all rays, or stops early when `watch` returns false. Throws sim::Deadlock if rays do not finish.
  void run();
  /// Returns the number of rays that the machine has finished.
  std::uint64_t ray_count() const { return done_.rays; }
  sim::Time elapsed_time() const { return elapsed_; }
  std::uint64_t elapsed_cycles() const { return clock_.cycles(elapsed_); }
  std::uint64_t hit_count() const;
  std::uint64_t step_count() const;
  std::vector<sim::UnitReport> unit_reports() const { return machine_.report(); }

  // Interface for the engine (sim/engine.h).
  sim::Machine& machine() { return machine_; }
  bool done() const;
  sim::Time livelock_timeout() const;

 private:
  struct Core {
    CoreRays rays;
    RaySource<CoreRays>* source = nullptr;
  };
  void add_core(std::uint32_t core, const traces::MemoryImage& image, std::span<const std::uint32_t> parents,
                std::span<const traces::Ray> rays, traces::RayKind kind);

  const GpuConfig config_;
  const sim::Clock clock_;
  const traces::BvhTracer tracer_;
  const ProgressCallback watch_;
  RayProgress done_;
  sim::Machine machine_;
  MemorySystem memory_;
  std::deque<Core> cores_;
  sim::Time elapsed_ = 0;
};

}  // namespace hw
