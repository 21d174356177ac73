#include "hw_models/frame/memory_interface.h"

#include <algorithm>

#include <fmt/format.h>

namespace hw {
namespace {

MemoryInterface::Rays::Shape ray_ring_shape(const DirectInterfaceConfig& config, Addr base, std::uint16_t client) {
  return {base, config.ray_bytes, config.ring, config.depth, client};
}
MemoryInterface::Hits::Shape hit_ring_shape(const DirectInterfaceConfig& config, Addr base, std::uint16_t client) {
  return {base + MemoryInterface::Rays::memory_bytes(ray_ring_shape(config, base, client)), config.hit_bytes,
          config.ring, config.depth, static_cast<std::uint16_t>(client + 1)};
}

}  // namespace

MemoryInterface::MemoryInterface(const DirectInterfaceConfig& config, Addr base, std::uint16_t client,
                                 const Rays::Links& rays, const Hits::Links& hits, sim::Clock clock)
    : clock_(clock),
      rays_(ray_ring_shape(config, base, client), rays),
      hits_(hit_ring_shape(config, base, client), hits) {}

Addr MemoryInterface::memory_bytes(const DirectInterfaceConfig& config) {
  return Rays::memory_bytes(ray_ring_shape(config, 0, 0)) + Hits::memory_bytes(hit_ring_shape(config, 0, 0));
}

sim::Time MemoryInterface::tick(sim::Time now) {
  bool moved = hits_.tick(now);
  moved |= rays_.tick(now);
  constexpr std::array kWaits{CycleReason::kIdle, CycleReason::kMemory, CycleReason::kPortFull,
                              CycleReason::kOutputFull};
  const auto waits =
      std::max(static_cast<std::size_t>(hits_.wait_state(now)), static_cast<std::size_t>(rays_.wait_state(now)));
  const CycleReason then = kWaits[waits];
  activity_.spend(now, clock_.period(), moved ? CycleReason::kMoving : then, then);
  const sim::Time next = clock_.edge_after(now, 1);
  return std::min(hits_.next_wake(next), rays_.next_wake(next));
}

void MemoryInterface::finish(sim::Time end) {
  activity_.finish(end);
  const Rays::Counts& rays = rays_.transfer_counts();
  const Hits::Counts& hits = hits_.transfer_counts();
  stats_ = {.rays = rays.records,
            .hits = hits.records,
            .ray_writes = rays.written,
            .ray_reads = rays.read,
            .hit_writes = hits.written,
            .hit_reads = hits.read,
            .ray_latency = clock_.cycles(rays_.latency_sum().sum_at(end)),
            .hit_latency = clock_.cycles(hits_.latency_sum().sum_at(end))};
}

std::string MemoryInterface::state() const {
  return fmt::format("{} rays and {} hits on their way through memory", rays_.records_inside(), hits_.records_inside());
}

}  // namespace hw
