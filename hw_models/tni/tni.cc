#include "hw_models/tni/tni.h"

namespace hw {

namespace {

template <class T>
std::vector<sim::Link<T>*> pointers(std::deque<sim::Link<T>>& links) {
  std::vector<sim::Link<T>*> out;
  for (sim::Link<T>& link : links) out.push_back(&link);
  return out;
}

}  // namespace

Tni::Tni(const TniConfig& config, const Scene& scene, std::uint32_t hit_interval, const Links& links,
         sim::Clock clock) {
  for (std::uint32_t i = 0; i < config.trvs; ++i) {
    auto& rays = to_trv_.emplace_back(config.link_depth, 1, clock);
    auto& done = from_trv_.emplace_back(config.link_depth, 1, clock);
    auto& leaves = to_ist_.emplace_back(config.trv.leaf_latency + config.link_depth, config.trv.leaf_latency, clock);
    auto& answers = from_ist_.emplace_back(config.trv.rays, 1, clock);
    trvs_.emplace_back(config.trv, scene.tree,
                       Trv::Links{rays, done, leaves, answers, *links.memory_out[i], *links.memory_in[i]},
                       static_cast<std::uint16_t>(i), clock);
  }
  ist_ = std::make_unique<Ist>(
      config.ist, scene.triangles,
      Ist::Links{pointers(to_ist_), pointers(from_ist_), *links.memory_out[config.trvs], *links.memory_in[config.trvs]},
      static_cast<std::uint16_t>(config.trvs), clock);
  dispatcher_ = std::make_unique<RayDispatcher>(
      config.trv.rays, hit_interval,
      RayDispatcher::Links{links.rays_in, links.hits_out, pointers(to_trv_), pointers(from_trv_)}, clock);
}

void Tni::wakes(sim::Time* dispatcher, sim::Time* ist, const std::vector<sim::Time*>& trvs) {
  for (std::size_t i = 0; i < trvs_.size(); ++i) {
    to_trv_[i].wakes(dispatcher, trvs[i]);
    from_trv_[i].wakes(trvs[i], dispatcher);
    to_ist_[i].wakes(trvs[i], ist);
    from_ist_[i].wakes(ist, trvs[i]);
  }
}

}  // namespace hw
