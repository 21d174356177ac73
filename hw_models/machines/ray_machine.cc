#include "hw_models/machines/ray_machine.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "hw_models/tni/scene_in_memory.h"
#include "sim/engine.h"
#include "traces/walk_steps.h"

namespace hw {

namespace {

/// Of each core's T&I unit: the TRVs, then the IST.
std::vector<MemoryNet::Client> clients(const GpuConfig& config) {
  std::vector<MemoryNet::Client> all(config.tni.trvs, {config.clocks.tni.clock(), config.tni.trv.l1.mshrs});
  all.push_back({config.clocks.tni.clock(), config.tni.ist.l1.mshrs});
  return all;
}

Tni::Links links_of(MemoryNet& net, std::uint32_t core, std::uint32_t ports, sim::Link<RayJob>& jobs,
                    sim::Link<RayDone>& dones) {
  Tni::Links links{jobs, dones, {}, {}};
  for (std::uint32_t p = 0; p < ports; ++p) {
    links.memory_out.push_back(&net.requests(core, p));
    links.memory_in.push_back(&net.responses(core, p));
  }
  return links;
}

}  // namespace

CoreRays::CoreRays(std::span<const traces::Ray> rays, const traces::Tracer& tracer, std::uint32_t core,
                   std::uint32_t cores, Finished finished)
    : rays_(rays), tracer_(tracer), core_(core), cores_(cores), finished_(std::move(finished)), hit_(kBlock) {
  for (std::uint32_t block = 0; !block_of(block).empty(); ++block) {
    count_ += static_cast<std::uint32_t>(block_of(block).size());
  }
}

std::span<const traces::Ray> CoreRays::block_of(std::uint32_t block) const {
  const std::size_t begin = std::min(rays_.size(), (core_ + std::size_t{cores_} * block) * kBlock);
  return rays_.subspan(begin, std::min<std::size_t>(kBlock, rays_.size() - begin));
}

void CoreRays::trace_next() {
  const auto rays = block_of(first_ + static_cast<std::uint32_t>(blocks_.size()));
  if (spare_.empty()) spare_.emplace_back();
  blocks_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  Block& block = blocks_.back();
  block.words.clear();
  block.begin.clear();
  block.left = static_cast<std::uint32_t>(rays.size());
  traces::WalkSink sink{block.words, block.begin};
  tracer_.trace(rays, traces::RayKind::kPrimary, std::span(hit_).first(rays.size()), &sink);
  hits_ += static_cast<std::uint64_t>(
      std::count_if(hit_.begin(), hit_.begin() + block.left, [](const traces::Hit& hit) { return hit.is_hit(); }));
  steps_ += traces::count_steps(block.words);
}

const std::uint32_t* CoreRays::walk(std::uint32_t ray) {
  while (ray / kBlock >= first_ + blocks_.size()) trace_next();
  const Block& block = blocks_[ray / kBlock - first_];
  return block.words.data() + block.begin[ray % kBlock];
}

void CoreRays::returned(std::uint32_t ray, sim::Time now) {
  blocks_[ray / kBlock - first_].left -= 1;
  for (; !blocks_.empty() && blocks_.front().left == 0; ++first_) {
    const auto traced = first_ + static_cast<std::uint32_t>(blocks_.size());
    spare_.push_back(std::move(blocks_.front()));
    blocks_.pop_front();
    const bool goes_on = finished_(static_cast<std::uint32_t>(block_of(first_).size()), now);
    if (!goes_on) count_ = std::min(count_, traced * kBlock);
  }
}

RayMachine::Core::Core(RayMachine& m, std::span<const traces::Ray> list, const traces::MemoryImage& image,
                       std::span<const std::uint32_t> parents, std::uint32_t core)
    : rays(list, m.tracer_, core, m.config_.cores,
           [&m](std::uint32_t finished, sim::Time now) {
             m.done_.blocks += 1;
             m.done_.rays += finished;
             m.done_.cycles = m.clock_.cycles(now);
             return m.watch_(m.done_);
           }),
      jobs(m.config_.direct_interface.depth, 1, m.clock_),
      dones(m.config_.direct_interface.depth, 1, m.clock_),
      source(m.clock_, m.config_.direct_interface.interval, rays, jobs, dones),
      tni(m.config_.tni, {m.config_.ideal.tni, m.config_.ideal.l1}, scene_in_memory(image, parents),
          m.config_.direct_interface.interval, links_of(m.net_, core, m.config_.tni.trvs + 1, jobs, dones), m.clock_) {
  const auto wake = [&](std::size_t place) { return m.wakes_.of(core * m.units_per_core() + place); };
  jobs.wakes(wake(0), wake(1));
  dones.wakes(wake(1), wake(0));
  std::vector<sim::Waker> trvs;
  for (std::uint32_t t = 0; t < m.config_.tni.trvs; ++t) trvs.push_back(wake(3 + t));
  tni.wakes(wake(1), wake(2), trvs);
}

RayMachine::RayMachine(const GpuConfig& config, const traces::MemoryImage& image,
                       std::span<const std::uint32_t> parents, std::span<const traces::Ray> rays, Watch watch)
    : config_(config),
      clock_(config.clocks.tni.clock()),
      tracer_(image),
      watch_(std::move(watch)),
      wakes_(config.cores * units_per_core() + MemoryNet::units(config)),
      net_(config_, clients(config_), wakes_, config.cores * units_per_core(),
           [this](std::uint32_t core, std::uint32_t client) {
             const std::size_t place = client == config_.tni.trvs ? 2 : 3 + std::size_t{client};
             return wakes_.of(core * units_per_core() + place);
           }) {
  for (std::uint32_t core = 0; core < config.cores; ++core) cores_.emplace_back(*this, rays, image, parents, core);
}

void RayMachine::run() {
  elapsed_ = clock_.edge_at_or_after(sim::run(*this) + 1);
  const auto finish = [&](auto& unit, std::size_t) { unit.finish(unit.clock().edge_at_or_after(elapsed_)); };
  for (Core& core : cores_) {
    finish(core.tni.dispatcher(), 0);
    finish(core.tni.ist(), 0);
    for (Trv& trv : core.tni.trvs()) finish(trv, 0);
  }
  net_.each_unit(finish, 0);
}

bool RayMachine::done() const {
  return std::ranges::all_of(cores_,
                             [](const Core& core) {
                               return core.source.done() &&
                                      std::ranges::all_of(core.tni.trvs(), [](const Trv& trv) { return trv.idle(); });
                             }) &&
         net_.quiet();
}

std::string RayMachine::state() const {
  std::string text;
  for (const Core& core : cores_) {
    text += core.tni.dispatcher().state() + "\n" + core.tni.ist().state() + "\n";
    for (const Trv& trv : core.tni.trvs()) text += trv.state() + "\n";
  }
  return text + net_.state();
}

std::uint64_t RayMachine::hits() const {
  std::uint64_t sum = 0;
  for (const Core& core : cores_) sum += core.rays.hits();
  return sum;
}

std::uint64_t RayMachine::steps() const {
  std::uint64_t sum = 0;
  for (const Core& core : cores_) sum += core.rays.steps();
  return sum;
}

std::vector<sim::UnitReport> RayMachine::report() const {
  using sim::report_of;
  std::vector<sim::UnitReport> units;
  for (std::size_t c = 0; c < cores_.size(); ++c) {
    const std::string at = fmt::format("core{}", c);
    const Tni& tni = cores_[c].tni;
    units.push_back(report_of(tni.dispatcher(), at + ".tni.dispatcher", "tni"));
    for (std::size_t t = 0; t < tni.trvs().size(); ++t) {
      units.push_back(report_of(tni.trvs()[t], fmt::format("{}.tni.trv{}", at, t), "tni", config_.tni.trv_sram_bytes(),
                                config_.tni.trv.l1.size.bytes));
    }
    units.push_back(
        report_of(tni.ist(), at + ".tni.ist", "tni", config_.tni.ist_sram_bytes(), config_.tni.ist.l1.size.bytes));
    units.push_back(report_of(net_.ports()[c], at + ".cache_port", "interconnect"));
  }
  for (std::size_t b = 0; b < net_.banks().size(); ++b) {
    units.push_back(report_of(net_.banks()[b], fmt::format("l2.bank{}", b), "l2",
                              config_.l2.cache.size.bytes / config_.l2.banks, config_.l2.cache.size.bytes));
  }
  for (std::size_t k = 0; k < net_.channels().size(); ++k) {
    units.push_back(report_of(net_.channels()[k], fmt::format("dram.channel{}", k), "dram"));
  }
  return units;
}

}  // namespace hw
