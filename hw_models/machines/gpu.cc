#include "hw_models/machines/gpu.h"

#include <algorithm>

#include <fmt/format.h>

#include "hw_models/tni/scene_in_memory.h"
#include "shader_kernels/catalogue.h"

namespace hw {

namespace {

constexpr std::uint32_t kIdealDepth = 256;  // of the links of an ideal interconnect: more than is under way at once

/// Bytes set aside for a core's largest spill: a chunk's rays and hits, two batches of them.
Addr spill_bytes(const GpuConfig& config) { return Addr{4} * config.srp.chunk * config.tile_buffer.slot_bytes; }

/// Behind the scene lie the frame's regions, behind them each core's room for its largest spill.
std::array<Addr, kAreas> areas_of(const GpuConfig& config, const Gpu::Workload& workload, std::uint32_t core) {
  std::array<Addr, kAreas> areas{};
  Addr next = workload.image.layout.frame_buffer;
  for (std::size_t region = 0; region < kRegions; ++region) {
    areas[region] = next;
    next = whole_lines(next + workload.region_bytes[region]);
  }
  areas[static_cast<std::size_t>(Area::kSpill)] = whole_lines(next + core * spill_bytes(config));
  return areas;
}

/// Behind the spills lie the rays and hits of each core that has no direct interface.
Addr records_of(const GpuConfig& config, const Gpu::Workload& workload, std::uint32_t core) {
  const Addr spills_end = areas_of(config, workload, config.cores)[static_cast<std::size_t>(Area::kSpill)];
  return spills_end + core * MemoryInterface::bytes_of(config.direct_interface);
}

}  // namespace

/// Places among the wake-up times and the links between cores and memory.
struct Gpu::Wiring {
  const std::uint32_t trvs, cores, banks, channels;
  const std::size_t places_of_core;
  sim::Wakes& wakes;

  // [core][bank] and so on; requests go to memory, responses come back.
  std::vector<std::vector<sim::Link<MemRequest>*>> core_bank_up, core_channel_up, bank_channel_up;
  std::vector<std::vector<sim::Link<MemResponse>*>> core_bank_down, core_channel_down, bank_channel_down;

  sim::Waker in_core(std::uint32_t c, std::size_t i) const { return wakes.of(c * places_of_core + i); }
  sim::Waker srp(std::uint32_t c) const { return in_core(c, 0); }
  sim::Waker ray_dispatcher(std::uint32_t c) const { return in_core(c, 1); }
  sim::Waker trv(std::uint32_t c, std::uint32_t t) const { return in_core(c, 2 + t); }
  sim::Waker ist(std::uint32_t c) const { return in_core(c, 2 + trvs); }
  sim::Waker cache_port(std::uint32_t c) const { return in_core(c, 3 + trvs); }
  sim::Waker dma(std::uint32_t c) const { return in_core(c, 4 + trvs); }
  sim::Waker dma_port(std::uint32_t c) const { return in_core(c, 5 + trvs); }
  sim::Waker memory_interface(std::uint32_t c) const { return in_core(c, 6 + trvs); }
  sim::Waker dispatcher() const { return in_core(cores, 0); }
  sim::Waker bank(std::uint32_t b) const { return in_core(cores, 1 + b); }
  sim::Waker channel(std::uint32_t k) const { return in_core(cores, 1 + banks + k); }
};

Gpu::Gpu(const GpuConfig& config, const Workload& workload, TileSource& tiles)
    : config_(config),
      layout_(workload.image.layout),
      tni_clock_(config.clocks.tni.clock()),
      srp_clock_(config.clocks.srp.clock()),
      l2_clock_(config.clocks.l2.clock()),
      dram_clock_(config.dram.timing.ck.time),
      places_of_core_(sim::Wakes::whole_groups(6 + config.tni.trvs + !config.direct_interface.enabled)) {
  SrpConfig srp = config.srp;
  if (config.ideal.tile_buffer) srp.array.local_ports = 64;  // more than any kernel can use
  for (const kernels::KernelInfo& kernel : kernels::catalogue()) {
    kernels_.push_back(schedule(kernel.graph, srp));
    conflicts_.push_back(bank_conflicts(kernels_.back(), kernel.graph, config.tile_buffer.banks));
  }
  Wiring wiring{config.tni.trvs,
                config.cores,
                config.l2.banks,
                config.dram.channels,
                places_of_core_,
                wakes_,
                {},
                {},
                {},
                {},
                {},
                {}};
  wakes_.reset(places_of_core_ * config.cores + sim::Wakes::whole_groups(1 + config.l2.banks + config.dram.channels),
               sim::kNever);

  const bool ideal = config.ideal.interconnect;
  const std::uint32_t distance = ideal ? 1 : config.interconnect.latency;
  const std::uint32_t link_depth = ideal ? kIdealDepth : config.interconnect.link_depth;
  const auto request = [&](std::uint32_t latency, sim::Clock to, sim::Waker from_unit, sim::Waker to_unit) {
    auto& link = requests_.emplace_back(link_depth + latency, latency, l2_clock_, to,
                                        to == l2_clock_ ? 0 : config.clocks.synchroniser);
    link.wakes(from_unit, to_unit);
    return &link;
  };
  const auto response = [&](std::uint32_t latency, sim::Clock from, sim::Waker from_unit, sim::Waker to_unit) {
    auto& link = responses_.emplace_back(link_depth + latency, latency, from, l2_clock_,
                                         from == l2_clock_ ? 0 : config.clocks.synchroniser);
    link.wakes(from_unit, to_unit);
    return &link;
  };
  for (std::uint32_t c = 0; c < config.cores; ++c) {
    auto& up = wiring.core_bank_up.emplace_back();
    auto& down = wiring.core_bank_down.emplace_back();
    for (std::uint32_t b = 0; b < config.l2.banks; ++b) {
      up.push_back(request(distance, l2_clock_, wiring.cache_port(c), wiring.bank(b)));
      down.push_back(response(distance, l2_clock_, wiring.bank(b), wiring.cache_port(c)));
    }
    auto& dma_up = wiring.core_channel_up.emplace_back();
    auto& dma_down = wiring.core_channel_down.emplace_back();
    for (std::uint32_t k = 0; k < config.dram.channels; ++k) {
      dma_up.push_back(request(distance, dram_clock_, wiring.dma_port(c), wiring.channel(k)));
      dma_down.push_back(response(distance, dram_clock_, wiring.channel(k), wiring.dma_port(c)));
    }
  }
  for (std::uint32_t b = 0; b < config.l2.banks; ++b) {
    auto& up = wiring.bank_channel_up.emplace_back();
    auto& down = wiring.bank_channel_down.emplace_back();
    for (std::uint32_t k = 0; k < config.dram.channels; ++k) {
      up.push_back(request(1, dram_clock_, wiring.bank(b), wiring.channel(k)));
      down.push_back(response(1, dram_clock_, wiring.channel(k), wiring.bank(b)));
    }
  }

  TileDispatcher::Links tile_links;
  for (std::uint32_t c = 0; c < config.cores; ++c) {
    add_core(wiring, c, workload);
    tile_links.to_core.push_back(&tile_jobs_[c]);
    tile_links.from_core.push_back(&tile_dones_[c]);
  }
  add_memory(wiring);
  for (auto& flush : flushes_) tile_links.to_l2.push_back(&flush);
  dispatcher_ = std::make_unique<TileDispatcher>(tiles, config.tile_buffer.tiles_in_flight, tile_links, l2_clock_);
  each_unit([&](auto&, std::size_t place) { wakes_.lower(place, 0); });
  add_partitions(wiring);
}

void Gpu::add_partitions(const Wiring& wiring) {
  const std::size_t core = places_of_core_ / sim::Wakes::kGroup, all = wakes_.size() / sim::Wakes::kGroup;
  partitions_.inner.units = {config_.cores * core, all};
  partitions_.outer.resize(config_.cores);
  lookahead_ = tile_jobs_.front().latency() + tile_dones_.front().latency();
  dma_lookahead_ = sim::kNever;
  for (std::size_t c = 0; c < config_.cores; ++c) {
    sim::Partition& partition = partitions_.outer[c];
    partition.units = {c * core, (c + 1) * core};
    const auto inward = [&](const auto& links) {
      for (auto* link : links) {
        link->count_if_nearly_full(&partition.nearly_full);
        lookahead_ = std::min(lookahead_, link->latency());
      }
    };
    inward(wiring.core_bank_up[c]);
    inward(wiring.core_channel_up[c]);
    for (const auto* link : wiring.core_bank_down[c]) lookahead_ = std::min(lookahead_, link->latency());
    for (const auto* link : wiring.core_channel_down[c]) dma_lookahead_ = std::min(dma_lookahead_, link->latency());
    tile_dones_[c].count_if_nearly_full(&partition.nearly_full);
  }
}

sim::Time Gpu::lookahead_end(sim::Time now) const {
  // At the end every time at which the machine may be done counts. An ideal port does not stop at a nearly full link.
  if (!dispatcher_->has_more() || config_.ideal.interconnect) return now;
  const sim::Time next_tile = wakes_[first_of_core(cores_.size())] + tile_jobs_.front().latency();
  const bool dma_reads = std::ranges::any_of(cores_, [](const Core& core) { return core.dma->awaits_lines(); });
  return std::min(now + (dma_reads ? std::min(lookahead_, dma_lookahead_) : lookahead_), next_tile);
}

void Gpu::add_core(Wiring& wiring, std::uint32_t c, const Workload& workload) {
  const std::uint32_t trvs = config_.tni.trvs;
  const std::uint32_t sync = config_.clocks.synchroniser;
  const std::uint32_t in_flight = config_.tile_buffer.tiles_in_flight;
  const traces::Layout& layout = workload.image.layout;

  auto& tiles_in = tile_jobs_.emplace_back(in_flight, 1, l2_clock_, srp_clock_, sync);
  auto& tiles_out = tile_dones_.emplace_back(in_flight + 1, 1, srp_clock_, l2_clock_, sync);  // never full
  // The direct interface, or its halves between each end and the memory interface.
  const DirectInterfaceConfig& direct = config_.direct_interface;
  const sim::Clock ray_reader = direct.enabled ? tni_clock_ : l2_clock_;
  const sim::Clock hit_reader = direct.enabled ? srp_clock_ : l2_clock_;
  auto& rays_from_srp = ray_jobs_.emplace_back(direct.depth, 1, srp_clock_, ray_reader, sync);
  auto& hits_from_tni = ray_dones_.emplace_back(direct.depth, 1, tni_clock_, hit_reader, sync);
  auto& rays = direct.enabled ? rays_from_srp : ray_jobs_.emplace_back(direct.depth, 1, l2_clock_, tni_clock_, sync);
  auto& hits = direct.enabled ? hits_from_tni : ray_dones_.emplace_back(direct.depth, 1, l2_clock_, srp_clock_, sync);
  auto& dma_in = dma_jobs_.emplace_back(in_flight, 1, srp_clock_);
  auto& dma_out = dma_dones_.emplace_back(in_flight, 1, srp_clock_);
  tiles_in.wakes(wiring.dispatcher(), wiring.srp(c));
  tiles_out.wakes(wiring.srp(c), wiring.dispatcher());
  if (direct.enabled) {
    rays.wakes(wiring.srp(c), wiring.ray_dispatcher(c));
    hits.wakes(wiring.ray_dispatcher(c), wiring.srp(c));
  } else {
    rays_from_srp.wakes(wiring.srp(c), wiring.memory_interface(c));
    rays.wakes(wiring.memory_interface(c), wiring.ray_dispatcher(c));
    hits_from_tni.wakes(wiring.ray_dispatcher(c), wiring.memory_interface(c));
    hits.wakes(wiring.memory_interface(c), wiring.srp(c));
  }
  dma_in.wakes(wiring.srp(c), wiring.dma(c));
  dma_out.wakes(wiring.dma(c), wiring.srp(c));

  // Clients of the core's port: the TRVs, the IST, the SRP's data cache.
  CorePort::Links port{{}, {}, wiring.core_bank_up[c], wiring.core_bank_down[c]};
  const auto client = [&](sim::Clock clock, std::uint32_t up_depth, std::uint32_t down_depth, sim::Waker unit,
                          sim::Waker port_unit, CorePort::Links& links) {
    const std::uint32_t crossing = clock == l2_clock_ ? 0 : sync;
    auto& up = requests_.emplace_back(up_depth, 1, clock, l2_clock_, crossing);
    auto& down = responses_.emplace_back(down_depth, 1, l2_clock_, clock, crossing);
    up.wakes(unit, port_unit);
    down.wakes(port_unit, unit);
    links.clients_in.push_back(&up);
    links.clients_out.push_back(&down);
  };
  const std::uint32_t requests = config_.ideal.interconnect ? kIdealDepth : kRequestDepth;
  for (std::uint32_t t = 0; t < trvs; ++t) {
    client(tni_clock_, requests, config_.tni.trv.l1.mshrs, wiring.trv(c, t), wiring.cache_port(c), port);
  }
  client(tni_clock_, requests, config_.tni.ist.l1.mshrs, wiring.ist(c), wiring.cache_port(c), port);
  client(srp_clock_, requests, config_.srp.data_cache.mshrs, wiring.srp(c), wiring.cache_port(c), port);
  if (!direct.enabled) {
    for (int way = 0; way < 2; ++way) {
      client(l2_clock_, requests, config_.interconnect.link_depth, wiring.memory_interface(c), wiring.cache_port(c),
             port);
    }
  }
  CorePort::Links dma_port{{}, {}, wiring.core_channel_up[c], wiring.core_channel_down[c]};
  client(srp_clock_, config_.dma.depth, config_.dma.depth, wiring.dma(c), wiring.dma_port(c), dma_port);

  Core& core = cores_.emplace_back();
  core.tni = std::make_unique<Tni>(config_.tni, Tni::Ideal{config_.ideal.tni, config_.ideal.l1},
                                   scene_in_memory(workload.image, workload.parents), direct.interval,
                                   Tni::Links{rays,
                                              hits_from_tni,
                                              {port.clients_in.begin(), port.clients_in.begin() + trvs + 1},
                                              {port.clients_out.begin(), port.clients_out.begin() + trvs + 1}},
                                   tni_clock_);
  std::vector<sim::Waker> trv_wakes;
  for (std::uint32_t t = 0; t < trvs; ++t) trv_wakes.push_back(wiring.trv(c, t));
  core.tni->wakes(wiring.ray_dispatcher(c), wiring.ist(c), trv_wakes);

  const Srp::Frame frame{.layout = &layout,
                         .kernels = kernels_,
                         .conflicts = conflicts_,
                         .tile_samples = workload.tile_samples,
                         .attribute_bytes = workload.attribute_bytes,
                         .ray_interval = config_.ideal.tni ? 0 : direct.interval * tni_clock_.period(),
                         .areas = areas_of(config_, workload, c),
                         .ideal = config_.ideal.srp,
                         .ideal_buffer = config_.ideal.tile_buffer,
                         .ideal_cache = config_.ideal.l1};
  core.srp = std::make_unique<Srp>(config_.srp, config_.tile_buffer, frame,
                                   Srp::Links{tiles_in, tiles_out, rays_from_srp, hits, *port.clients_in[trvs + 1],
                                              *port.clients_out[trvs + 1], dma_in, dma_out},
                                   static_cast<std::uint16_t>(trvs + 1), srp_clock_);
  core.dma =
      std::make_unique<Dma>(Dma::Links{dma_in, dma_out, *dma_port.clients_in.front(), *dma_port.clients_out.front()},
                            std::uint16_t{0}, srp_clock_);
  const std::uint64_t line = config_.l2.cache.line.bytes;
  core.cache_port = std::make_unique<CorePort>(config_.interconnect, port, config_.l2.interleave(), l2_clock_, line,
                                               config_.ideal.interconnect);
  core.dma_port = std::make_unique<CorePort>(config_.interconnect, dma_port, config_.dram.interleave(), l2_clock_, line,
                                             config_.ideal.interconnect);
  if (direct.enabled) return;
  memory_interfaces_.emplace_back(
      direct, records_of(config_, workload, c), static_cast<std::uint16_t>(trvs + 2),
      MemoryInterface::Rays::Links{rays_from_srp, rays, *port.clients_in[trvs + 2], *port.clients_out[trvs + 2]},
      MemoryInterface::Hits::Links{hits_from_tni, hits, *port.clients_in[trvs + 3], *port.clients_out[trvs + 3]},
      l2_clock_);
}

void Gpu::add_memory(Wiring& wiring) {
  for (std::uint32_t b = 0; b < config_.l2.banks; ++b) {
    L2Bank::Links links{{}, {}, wiring.bank_channel_up[b], wiring.bank_channel_down[b]};
    for (std::uint32_t c = 0; c < config_.cores; ++c) {
      links.cores_in.push_back(wiring.core_bank_up[c][b]);
      links.cores_out.push_back(wiring.core_bank_down[c][b]);
    }
    // Only rays and hits are ever written to the L2.
    if (!config_.direct_interface.enabled && config_.l2.writes == L2Writes::kBack && !config_.ideal.l2) {
      links.flush_in = &flushes_.emplace_back(1, 1, l2_clock_);
      links.flush_in->wakes(wiring.dispatcher(), wiring.bank(b));
    }
    banks_.emplace_back(config_.l2, static_cast<std::uint16_t>(b), links, config_.dram.interleave(), l2_clock_,
                        config_.interconnect.arbitration, config_.ideal.l2);
  }
  for (std::uint32_t k = 0; k < config_.dram.channels; ++k) {
    DramChannel::Links links;
    for (std::uint32_t b = 0; b < config_.l2.banks; ++b) {
      links.ports_in.push_back(wiring.bank_channel_up[b][k]);
      links.ports_out.push_back(wiring.bank_channel_down[b][k]);
    }
    for (std::uint32_t c = 0; c < config_.cores; ++c) {
      links.ports_in.push_back(wiring.core_channel_up[c][k]);
      links.ports_out.push_back(wiring.core_channel_down[c][k]);
    }
    channels_.emplace_back(config_.dram, links, config_.ideal.dram);
  }
}

bool Gpu::memory_quiet() const {
  const auto empty = [](const auto& link) { return link.empty(); };
  const auto idle = [](const auto& unit) { return unit.idle(); };
  // Traversal units may wait for lines that no ray needs yet.
  return std::ranges::all_of(channels_, idle) && std::ranges::all_of(banks_, idle) &&
         std::ranges::all_of(cores_, [&](const Core& core) { return std::ranges::all_of(core.tni->trvs(), idle); }) &&
         std::ranges::all_of(requests_, empty) && std::ranges::all_of(responses_, empty) &&
         std::ranges::all_of(flushes_, empty);
}

void Gpu::finish(sim::Time last_edge) {
  elapsed_ = tni_clock_.edge_at_or_after(last_edge + 1);
  each_unit([&](auto& unit, std::size_t) { unit.finish(unit.clock().edge_at_or_after(elapsed_)); });
}

std::string Gpu::state() {
  std::string out = fmt::format("tile_dispatcher: {}\n", dispatcher_->state());
  for (std::size_t c = 0; c < cores_.size(); ++c) {
    Core& core = cores_[c];
    out += fmt::format("core{}.srp: {}\n", c, core.srp->state());
    out += fmt::format("core{}.tni.dispatcher: {}\n", c, core.tni->dispatcher().state());
    for (std::size_t t = 0; t < core.tni->trvs().size(); ++t) {
      out += fmt::format("core{}.tni.trv{}: {}\n", c, t, core.tni->trvs()[t].state());
    }
    out += fmt::format("core{}.tni.ist: {}\n", c, core.tni->ist().state());
    out += fmt::format("core{}.dma: {}\n", c, core.dma->state());
    out += fmt::format("core{}.cache_port: {}\n", c, core.cache_port->state());
    out += fmt::format("core{}.dma_port: {}\n", c, core.dma_port->state());
  }
  for (std::size_t b = 0; b < banks_.size(); ++b) out += fmt::format("l2.bank{}: {}\n", b, banks_[b].state());
  for (std::size_t k = 0; k < channels_.size(); ++k)
    out += fmt::format("dram.channel{}: {}\n", k, channels_[k].state());
  for (std::size_t c = 0; c < memory_interfaces_.size(); ++c)
    out += fmt::format("core{}.memory_interface: {}\n", c, memory_interfaces_[c].state());
  return out;
}

std::vector<sim::UnitReport> Gpu::report() const {
  using sim::report_of;
  std::vector<sim::UnitReport> units;
  units.push_back(report_of(*dispatcher_, "tile_dispatcher", "interconnect"));
  for (std::size_t c = 0; c < cores_.size(); ++c) {
    const Core& core = cores_[c];
    const std::string at = fmt::format("core{}", c);
    units.push_back(
        report_of(*core.srp, at + ".srp", "srp", config_.srp.sram_bytes(), config_.srp.data_cache.size.bytes));
    units.push_back(
        report_of(core.srp->tile_buffer(), at + ".tile_buffer", "tile_buffer", config_.tile_buffer.size.bytes));
    units.push_back(report_of(core.tni->dispatcher(), at + ".tni.dispatcher", "tni"));
    for (std::size_t t = 0; t < core.tni->trvs().size(); ++t) {
      units.push_back(report_of(core.tni->trvs()[t], fmt::format("{}.tni.trv{}", at, t), "tni",
                                config_.tni.trv_sram_bytes(), config_.tni.trv.l1.size.bytes));
    }
    units.push_back(report_of(core.tni->ist(), at + ".tni.ist", "tni", config_.tni.ist_sram_bytes(),
                              config_.tni.ist.l1.size.bytes));
    units.push_back(report_of(*core.dma, at + ".dma", "dma"));
    units.push_back(report_of(*core.cache_port, at + ".cache_port", "interconnect"));
    units.push_back(report_of(*core.dma_port, at + ".dma_port", "interconnect"));
    if (c < memory_interfaces_.size()) {
      units.push_back(report_of(memory_interfaces_[c], at + ".memory_interface", "interconnect"));
    }
  }
  for (std::size_t b = 0; b < banks_.size(); ++b) {
    units.push_back(report_of(banks_[b], fmt::format("l2.bank{}", b), "l2",
                              config_.l2.cache.size.bytes / config_.l2.banks, config_.l2.cache.size.bytes));
  }
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    units.push_back(report_of(channels_[k], fmt::format("dram.channel{}", k), "dram"));
  }
  return units;
}

std::vector<KernelUse> Gpu::kernel_use() const {
  std::vector<KernelUse> sum(kernels_.size());
  for (const Core& core : cores_) {
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += core.srp->kernel_use()[k];
  }
  return sum;
}

}  // namespace hw
