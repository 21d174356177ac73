#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "hw_models/frame/direct_interface_config.h"
#include "hw_models/tni/tni_core.h"
#include "sim/machine.h"

namespace hw {

/// The shader core's end of the direct interface: a ray every so many cycles if there is room, hits taken at once.
///
/// `Rays` knows them by number: `count()`, `walk(ray)`, and `returned(ray, now)`, which is told of every hit.
template <class Rays>
class RaySource {
 public:
  RaySource(sim::Clock clock, std::uint32_t interval, Rays& rays, sim::Link<RayJob>& out, sim::Link<RayDone>& in)
      : clock_(clock), interval_(interval), rays_(rays), out_(out), in_(in) {}

  const sim::Clock& clock() const { return clock_; }
  sim::Time tick(sim::Time now) {
    if (in_.can_pop(now)) {
      rays_.returned(in_.pop(now).id, now);
      returned_ += 1;
    }
    if (sent_ < rays_.count() && now >= send_at_ && out_.can_push(now)) {
      out_.push(now, {rays_.walk(sent_), sent_});
      sent_ += 1;
      send_at_ = clock_.after(now, interval_);
    }
    const sim::Time next = clock_.after(now, 1);
    const sim::Time send = sent_ < rays_.count() ? std::max({next, send_at_, out_.push_at()}) : sim::kNever;
    return std::min(send, std::max(next, in_.pop_at()));
  }
  bool done() const { return returned_ == rays_.count(); }

 private:
  const sim::Clock clock_;
  const std::uint32_t interval_;
  Rays& rays_;
  sim::Link<RayJob>& out_;
  sim::Link<RayDone>& in_;
  std::uint32_t sent_ = 0, returned_ = 0;
  sim::Time send_at_ = 0;
};

/// Builds a core's T&I unit with a source of rays in the place of the shader core.
///
///   source --> direct interface --> T&I unit --> memory
template <class Rays>
RaySource<Rays>& build_source_and_tni(sim::Machine& machine, const DirectInterfaceConfig& direct, sim::UnitId source,
                                      Rays& rays, TniCore& tni, const TniCore::Scene& scene,
                                      std::span<const MemoryPort> memory) {
  auto& jobs = machine.link<RayJob>(direct.depth, 1, source, tni.dispatcher_id());
  auto& dones = machine.link<RayDone>(direct.depth, 1, tni.dispatcher_id(), source);
  auto& built = machine.build<RaySource<Rays>>(source, source.clock, direct.interval, rays, jobs, dones);
  tni.build(machine, scene, direct.interval, {jobs, dones, memory});
  return built;
}

}  // namespace hw
