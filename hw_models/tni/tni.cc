#include "hw_models/tni/tni.h"

namespace hw {

namespace {

template <class T>
std::vector<sim::Link<T>*> pointers(std::deque<sim::Link<T>>& links) {
  std::vector<sim::Link<T>*> out;
  for (sim::Link<T>& link : links) out.push_back(&link);
  return out;
}

/// Misses wait as they do under `reorder`, which lets all other rays go on.
TniConfig with_ideal_pipes(TniConfig config) {
  constexpr std::uint32_t kMost = 64;
  config.link_depth = kMost;
  config.miss_handling = MissHandling::kReorder;
  config.trv.rays = config.ist.leaves = kMost;
  config.trv.box_latency = config.trv.leaf_latency = config.trv.stack_latency = 1;
  config.trv.transform_latency = 1;
  config.ist.distance_stage = config.ist.barycentric_stage = config.ist.latency = 1;
  config.trv.l1.hit_cycles = config.ist.l1.hit_cycles = 0;
  return config;
}

}  // namespace

Tni::Tni(const TniConfig& given, const Ideal& ideal, const Scene& scene, std::uint32_t hit_interval, const Links& links,
         sim::Clock clock) {
  const TniConfig config = ideal.tni ? with_ideal_pipes(given) : given;
  const TniMode mode{config.miss_handling, config.rau, ideal.tni, ideal.l1};
  for (std::uint32_t i = 0; i < config.trvs; ++i) {
    auto& rays = to_trv_.emplace_back(config.link_depth, 1, clock);
    auto& done = from_trv_.emplace_back(config.link_depth, 1, clock);
    auto& leaves = to_ist_.emplace_back(config.trv.leaf_latency + config.link_depth, config.trv.leaf_latency, clock);
    auto& answers = from_ist_.emplace_back(config.trv.rays, 1, clock);
    trvs_.emplace_back(config.trv, mode, scene.tree,
                       Trv::Links{rays, done, leaves, answers, *links.memory_out[i], *links.memory_in[i]},
                       static_cast<std::uint16_t>(i), clock);
  }
  ist_ = std::make_unique<Ist>(
      config.ist, mode, scene.triangles,
      Ist::Links{pointers(to_ist_), pointers(from_ist_), *links.memory_out[config.trvs], *links.memory_in[config.trvs]},
      static_cast<std::uint16_t>(config.trvs), clock);
  dispatcher_ = std::make_unique<RayDispatcher>(
      RayDispatcher::Policy{config.dispatch, config.trv.rays, hit_interval, ideal.tni},
      RayDispatcher::Links{links.rays_in, links.hits_out, pointers(to_trv_), pointers(from_trv_)}, clock);
}

void Tni::wakes(sim::Waker dispatcher, sim::Waker ist, const std::vector<sim::Waker>& trvs) {
  for (std::size_t i = 0; i < trvs_.size(); ++i) {
    to_trv_[i].wakes(dispatcher, trvs[i]);
    from_trv_[i].wakes(trvs[i], dispatcher);
    to_ist_[i].wakes(trvs[i], ist);
    from_ist_[i].wakes(ist, trvs[i]);
  }
}

}  // namespace hw
