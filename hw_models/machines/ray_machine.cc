#include "hw_models/machines/ray_machine.h"

#include <algorithm>
#include <utility>

#include "hw_models/machines/livelock_timeout.h"
#include "hw_models/tni/tni_core.h"
#include "sim/engine.h"
#include "traces/walk.h"

namespace hw {

CoreRays::CoreRays(std::span<const traces::Ray> rays, traces::RayKind kind, const traces::Tracer& tracer,
                   const traces::RayKeyGrid& keys, std::uint32_t core, std::uint32_t cores, BlockCallback finished)
    : rays_(rays),
      kind_(kind),
      tracer_(tracer),
      keys_(keys),
      core_(core),
      cores_(cores),
      finished_(std::move(finished)),
      hit_(kBlock) {
  for (std::uint32_t block = 0; !rays_of_block(block).empty(); ++block) {
    count_ += static_cast<std::uint32_t>(rays_of_block(block).size());
  }
}

std::span<const traces::Ray> CoreRays::rays_of_block(std::uint32_t block) const {
  const std::size_t begin = std::min(rays_.size(), (core_ + std::size_t{cores_} * block) * kBlock);
  return rays_.subspan(begin, std::min<std::size_t>(kBlock, rays_.size() - begin));
}

void CoreRays::trace_next_block() {
  const auto rays = rays_of_block(first_ + static_cast<std::uint32_t>(blocks_.size()));
  if (spare_.empty()) spare_.emplace_back();
  blocks_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  Block& block = blocks_.back();
  block.words.clear();
  block.begin.clear();
  block.left = static_cast<std::uint32_t>(rays.size());
  traces::WalkSink sink{block.words, block.begin};
  tracer_.trace(rays, kind_, std::span(hit_).first(rays.size()), &sink);
  hits_ += static_cast<std::uint64_t>(
      std::count_if(hit_.begin(), hit_.begin() + block.left, [](const traces::Hit& hit) { return hit.is_hit(); }));
  steps_ += traces::count_steps(block.words).total_steps();
}

const std::uint32_t* CoreRays::ray_walk(std::uint32_t ray) {
  while (ray / kBlock >= first_ + blocks_.size()) trace_next_block();
  const Block& block = blocks_[ray / kBlock - first_];
  return block.words.data() + block.begin[ray % kBlock];
}

std::uint32_t CoreRays::ray_key(std::uint32_t ray) const {
  return keys_.key_of(rays_of_block(ray / kBlock)[ray % kBlock]);
}

void CoreRays::record_return_time(std::uint32_t ray, sim::Time now) {
  blocks_[ray / kBlock - first_].left -= 1;
  for (; !blocks_.empty() && blocks_.front().left == 0; ++first_) {
    const auto traced = first_ + static_cast<std::uint32_t>(blocks_.size());
    spare_.push_back(std::move(blocks_.front()));
    blocks_.pop_front();
    const bool goes_on = finished_(static_cast<std::uint32_t>(rays_of_block(first_).size()), now);
    if (!goes_on) count_ = std::min(count_, traced * kBlock);
  }
}

RayMachine::RayMachine(const GpuConfig& config, const traces::MemoryImage& image,
                       std::span<const std::uint32_t> parents, std::span<const traces::Ray> rays, traces::RayKind kind,
                       ProgressCallback watch)
    : config_(config),
      clock_(config.clocks.tni.clock()),
      tracer_(image),
      watch_(std::move(watch)),
      machine_(config.clocks.synchroniser),
      memory_(machine_, config_, MemorySystem::Dma::kNo) {
  for (std::uint32_t core = 0; core < config.cores; ++core) add_core(core, image, parents, rays, kind);
  memory_.build_banks_and_channels();
}

void RayMachine::add_core(std::uint32_t c, const traces::MemoryImage& image, std::span<const std::uint32_t> parents,
                          std::span<const traces::Ray> rays, traces::RayKind kind) {
  const auto finished = [this](std::uint32_t back, sim::Time now) {
    done_.blocks += 1;
    done_.rays += back;
    done_.cycles = clock_.cycles(now);
    return watch_(done_);
  };
  Core& core =
      cores_.emplace_back(Core{CoreRays(rays, kind, tracer_, {image.lower, image.upper}, c, config_.cores, finished)});
  const sim::UnitId source = machine_.unit({unit_name_in_core("core.rays", c), clock_, c + 1});
  memory_.declare_ports();
  TniCore tni(machine_, config_.tni, {config_.ideal.tni, config_.ideal.l1}, c, clock_, tree_kind(image));
  const std::vector<MemoryPort> ports = memory_.add_cache_clients(c, tni.memory_clients());
  core.source = &build_source_and_tni(machine_, config_.direct_interface, source, core.rays, tni,
                                      scene_in_memory(image, parents), ports);
  memory_.build_ports(c);
}

void RayMachine::run() {
  elapsed_ = clock_.edge_at_or_after(sim::run(*this) + 1);
  machine_.finish(elapsed_);
}

bool RayMachine::done() const {
  return std::ranges::all_of(cores_, [](const Core& core) { return core.source->is_done(); }) && machine_.is_drained();
}

sim::Time RayMachine::livelock_timeout() const { return hw::livelock_timeout(config_, {}, {}); }

std::uint64_t RayMachine::hit_count() const {
  std::uint64_t sum = 0;
  for (const Core& core : cores_) sum += core.rays.hit_count();
  return sum;
}

std::uint64_t RayMachine::step_count() const {
  std::uint64_t sum = 0;
  for (const Core& core : cores_) sum += core.rays.step_count();
  return sum;
}

}  // namespace hw
