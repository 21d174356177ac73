#include "hw_models/machines/gpu.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "hw_models/frame/tile_lines.h"
#include "hw_models/machines/livelock_timeout.h"
#include "hw_models/tni/tni_core.h"
#include "shader_kernels/catalogue.h"
#include "sim/hash.h"

namespace hw {

ScheduledKernels schedule_kernels(const GpuConfig& config) {
  SrpConfig srp = config.srp;
  if (config.ideal.tile_buffer) srp.array.local_ports = 64;  // more ports than any kernel can use
  ScheduledKernels out;
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    out.kernels.push_back(schedule_kernel(kernel.graph, srp));
    out.conflicts.push_back(bank_conflicts(out.kernels.back(), kernel.graph, config.tile_buffer.banks));
  }
  return out;
}

namespace {

constexpr std::uint32_t kStarts = 8;   // a core starts 0 to 7 cycles after time 0
constexpr std::uint32_t kFabrics = 3;  // DRAM fabric latency changes by -1, 0 or +1 cycles

}  // namespace

Perturbation random_perturbation(std::uint32_t cores, std::uint32_t frame, std::uint32_t replicate) {
  Perturbation drawn;
  if (replicate == 0) return drawn;
  for (std::uint32_t core = 0; core < cores; ++core) {
    drawn.starts.push_back(static_cast<std::uint32_t>(sim::hash(frame, replicate, 1, core) % kStarts));
  }
  drawn.dram.fabric = static_cast<std::int32_t>(sim::hash(frame, replicate, 2) % kFabrics) - 1;
  drawn.dram.refresh = static_cast<std::uint32_t>(sim::hash(frame, replicate, 3));
  return drawn;
}

namespace {

/// Returns the size in bytes of a core's memory for spilled rays. It holds two batches of rays and their hits, as one
/// chunk of a kernel launch can emit them.
Addr spill_bytes(const GpuConfig& config) { return Addr{4} * config.srp.chunk * config.tile_buffer.slot_bytes; }

/// Returns the start address of each Area in memory: the frame's regions after the scene, then the given core's space
/// for spilled rays.
std::array<Addr, kAreas> memory_areas_of_core(const GpuConfig& config, const Gpu::Workload& workload,
                                              std::uint32_t core) {
  std::array<Addr, kAreas> areas{};
  Addr next = round_up_to_lines(workload.image.layout.frame_buffer + tree_table_bytes(workload.image, config.tni.trv));
  for (std::size_t region = 0; region < kRegions; ++region) {
    if (region == static_cast<std::size_t>(traces::Region::kTree)) {
      areas[region] = workload.image.layout.nodes;  // not set aside: the tree is part of the scene
      continue;
    }
    areas[region] = next;
    next = round_up_to_lines(next + workload.needs.region_bytes[region]);
  }
  areas[static_cast<std::size_t>(Area::kSpill)] = round_up_to_lines(next + core * spill_bytes(config));
  return areas;
}

/// Returns the start address of a core's ring buffers for rays and hits, used if shader core and T&I unit have no
/// direct interface.
Addr record_memory_of_core(const GpuConfig& config, const Gpu::Workload& workload, std::uint32_t core) {
  const Addr spills_end = memory_areas_of_core(config, workload, config.cores)[static_cast<std::size_t>(Area::kSpill)];
  return spills_end + core * MemoryInterface::memory_bytes(config.direct_interface);
}

/// Returns the addresses of the arrays that the rasterisers of all cores share. These arrays follow the memory areas of
/// the cores.
RasterMemory raster_memory_of(const GpuConfig& config, const Gpu::Workload& workload) {
  return {round_up_to_lines(record_memory_of_core(config, workload, config.cores)), *workload.needs.raster};
}

/// Returns the addresses of the tree builder's arrays, which follow all others.
BuildMemory build_memory_of(const GpuConfig& config, const Gpu::Workload& workload) {
  const Addr base = workload.needs.raster ? raster_memory_of(config, workload).end
                                          : round_up_to_lines(record_memory_of_core(config, workload, config.cores));
  return {base, workload.image.layout.nodes, *workload.needs.build, config.tree_builder.record_bytes};
}

}  // namespace

Gpu::Gpu(const GpuConfig& config, const Workload& workload, TileSource& tiles, const Perturbation& perturbation)
    : config_(config),
      layout_(workload.image.layout),
      stored_samples_(memory_areas_of_core(config, workload, 0)[static_cast<std::size_t>(Area::kSamples)]),
      tni_clock_(config.clocks.tni.clock()),
      srp_clock_(config.clocks.srp.clock()),
      l2_clock_(config.clocks.l2.clock()),
      tree_bytes_(workload.needs.region_bytes[static_cast<std::size_t>(traces::Region::kTree)]),
      in_flight_(tiles_in_flight(config.tile_buffer, workload.needs, config.ideal.tile_buffer)),
      scheduled_(workload.scheduled ? workload.scheduled
                                    : std::make_shared<const ScheduledKernels>(schedule_kernels(config))),
      machine_(config.clocks.synchroniser),
      memory_(machine_, config_, MemorySystem::Dma::kYes, perturbation.dram, workload.observer),
      dispatcher_id_(machine_.unit({TileDispatcher::kName, l2_clock_})) {
  livelock_timeout_ = hw::livelock_timeout(config, scheduled_->kernels, scheduled_->conflicts);

  TileDispatcher::Links links;
  links.observer = workload.observer;
  for (std::uint32_t c = 0; c < config.cores; ++c) {
    const Core& core = declare_core(c, tree_kind(workload.image));
    links.to_core.push_back(&core.tiles_in);
    links.from_core.push_back(&core.tiles_out);
  }
  if (workload.needs.build) {
    builder_wires_.emplace(link_builder());
    links.to_builder = &builder_wires_->jobs;
    links.from_builder = &builder_wires_->done;
    links.builds_overlap = workload.needs.build->shadow_bytes != 0;
  }
  // The L2 receives writes only of rays and hits without a direct interface, of a rasteriser's geometry pass, and of
  // the tree builder.
  const bool writes = !config.direct_interface.enabled || workload.needs.raster || workload.needs.build;
  const bool keeps_writes = writes && config.l2.writes == L2Writes::kBack && !config.ideal.l2;
  if (keeps_writes) links.to_l2 = memory_.create_flush_links(dispatcher_id_);
  for (sim::Link<Flush>* end : memory_.add_background_sources(dispatcher_id_)) links.to_l2.push_back(end);
  dispatcher_ =
      &machine_.build<TileDispatcher>(dispatcher_id_, tiles, in_flight_, links, l2_clock_, perturbation.starts);
  for (std::uint32_t c = 0; c < config.cores; ++c) build_core(c, workload);
  memory_.build_banks_and_channels();
}

Gpu::Core& Gpu::declare_core(std::uint32_t core_number, const TreeKind& tree) {
  const sim::UnitId srp =
      machine_.unit({unit_name_in_core(Srp::kName, core_number), srp_clock_, core_number + 1, config_.srp.sram_bytes(),
                     config_.srp.data_cache.size.bytes, config_.srp.array.parts()});
  const std::uint32_t in_flight = in_flight_.max_tiles();
  const auto known = sim::Lookahead::kByOwner;  // run_limits() computes the arrival times of their messages
  TniCore tni(machine_, config_.tni, {config_.ideal.tni, config_.ideal.l1}, core_number, tni_clock_, tree);
  memory_.declare_ports();
  return cores_.emplace_back(
      Core{srp, std::move(tni), machine_.link<TileJob>(in_flight, 1, dispatcher_id_, srp, known),
           machine_.link<TileDone>(TileDispatcher::max_messages(in_flight + 1), 1, srp, dispatcher_id_, known)});
}

Gpu::BuilderWires Gpu::link_builder() {
  const TreeBuilderConfig& config = config_.tree_builder;
  constexpr std::uint32_t kPartition = 1;  // that of core 0
  const sim::UnitId unit = machine_.unit(
      {TreeBuilder::kName, tni_clock_, kPartition, config.sram_bytes(), config.buffer.size.bytes, config.parts()});
  const auto known = sim::Lookahead::kByOwner;
  return {unit, machine_.link<TileJob>(TreeBuilder::kJobs, 1, dispatcher_id_, unit, known),
          machine_.link<TileDone>(2, 1, unit, dispatcher_id_, known)};
}

void Gpu::build_tree_builder(const Workload& workload, const MemoryPort& memory) {
  builder_ =
      &machine_.build<TreeBuilder>(builder_wires_->unit, config_.tree_builder, build_memory_of(config_, workload),
                                   TreeBuilder::Links{builder_wires_->jobs, builder_wires_->done, memory.requests,
                                                      memory.responses, workload.observer},
                                   memory.client, tni_clock_, config_.ideal.l1);
}

Gpu::Interface Gpu::link_interface(const Core& core, sim::UnitId memory_interface) {
  const std::size_t depth = config_.direct_interface.depth;
  const sim::UnitId srp = core.srp_id, tni = core.tni.dispatcher_id(), rays_in = core.tni.rays_in_id();
  if (config_.direct_interface.enabled) {
    auto& rays = machine_.link<RayJob>(depth, 1, srp, rays_in);
    auto& hits = machine_.link<RayDone>(depth, 1, tni, srp);
    return {rays, rays, hits, hits};
  }
  return {machine_.link<RayJob>(depth, 1, srp, memory_interface),
          machine_.link<RayJob>(depth, 1, memory_interface, rays_in),
          machine_.link<RayDone>(depth, 1, tni, memory_interface),
          machine_.link<RayDone>(depth, 1, memory_interface, srp)};
}

Gpu::RasterWires Gpu::link_rasteriser(const Core& core, std::uint32_t core_number) {
  const RasterUnitConfig& raster = config_.raster;
  const sim::UnitId unit = machine_.unit({unit_name_in_core(RasterUnit::kName, core_number), tni_clock_,
                                          core_number + 1, raster.sram_bytes(), raster.l1.size.bytes});
  auto& jobs = machine_.link<RasterJob>(raster.jobs, 1, core.srp_id, unit);
  auto& done = machine_.link<RasterDone>(2 * raster.jobs, 1, unit, core.srp_id);
  return {unit, jobs, done, memory_.add_cache_client(core_number, {unit, raster.l1.mshrs, RequesterKind::kRaster})};
}

Srp::Frame Gpu::srp_frame_of(const Workload& workload, std::uint32_t core) const {
  return {.layout = &layout_,
          .kernels = scheduled_->kernels,
          .conflicts = scheduled_->conflicts,
          .needs = workload.needs,
          .ray_interval = config_.ideal.tni ? 0 : config_.direct_interface.interval * tni_clock_.period(),
          .areas = memory_areas_of_core(config_, workload, core),
          .encode_cycles = workload.dma_encodes ? config_.tile_buffer.colour_bytes / traces::kPixelBytes : 0,
          .plane_bytes = config_.raster.plane_bytes,
          .ideal = config_.ideal.srp,
          .ideal_buffer = config_.ideal.tile_buffer,
          .ideal_cache = config_.ideal.l1,
          .observer = workload.observer,
          .core = core};
}

void Gpu::build_core(std::uint32_t core_number, const Workload& workload) {
  Core& core = cores_[core_number];
  const DirectInterfaceConfig& direct = config_.direct_interface;
  const sim::UnitId dma = machine_.unit({unit_name_in_core(Dma::kName, core_number), srp_clock_, core_number + 1});
  std::optional<sim::UnitId> between;
  if (!direct.enabled)
    between = machine_.unit({unit_name_in_core(MemoryInterface::kName, core_number), l2_clock_, core_number + 1});
  const Interface wires = link_interface(core, between.value_or(core.srp_id));

  const std::vector<MemoryPort> tni = memory_.add_cache_clients(core_number, core.tni.memory_clients());
  const MemoryPort data =
      memory_.add_cache_client(core_number, {core.srp_id, config_.srp.data_cache.mshrs, RequesterKind::kShading});
  const MemoryPort transfers = memory_.add_dma_client(core_number, dma);
  const std::uint32_t in_flight = in_flight_.max_tiles();
  auto& dma_jobs = machine_.link<DmaJob>(in_flight, 1, core.srp_id, dma);
  auto& dma_dones = machine_.link<DmaDone>(in_flight, 1, dma, core.srp_id);

  std::optional<RasterWires> raster;
  if (workload.needs.raster) raster.emplace(link_rasteriser(core, core_number));
  std::optional<MemoryPort> builder;
  if (builder_wires_ && core_number == 0) {
    builder.emplace(
        memory_.add_cache_client(0, {builder_wires_->unit, config_.tree_builder.buffer.mshrs, RequesterKind::kBuild}));
  }
  core.srp = &machine_.build<Srp>(
      core.srp_id, config_.srp, config_.tile_buffer, srp_frame_of(workload, core_number),
      Srp::Links{core.tiles_in, core.tiles_out, wires.rays_from_srp, wires.hits_to_srp, data.requests, data.responses,
                 dma_jobs, dma_dones, raster ? &raster->jobs : nullptr, raster ? &raster->done : nullptr},
      data.client, srp_clock_);
  machine_.report_subunit(unit_name_in_core(TileBuffer::kName, core_number), core.srp->tile_buffer(),
                          config_.tile_buffer.size.bytes);
  core.tni.build_units(machine_, scene_in_memory(workload.image, workload.parents), direct.interval,
                       {wires.rays_to_tni, wires.hits_from_tni, tni});
  core.dma = &machine_.build<Dma>(
      dma, Dma::Links{dma_jobs, dma_dones, transfers.requests, transfers.responses, workload.observer, core_number},
      transfers.client, srp_clock_);
  if (raster) {
    core.raster = &machine_.build<RasterUnit>(
        raster->unit, config_.raster, raster_memory_of(config_, workload),
        RasterUnit::Links{raster->jobs, raster->done, raster->memory.requests, raster->memory.responses},
        raster->memory.client, tni_clock_, config_.ideal.l1);
  }
  if (builder) build_tree_builder(workload, *builder);
  std::vector<MemoryPort> records;  // memory ports for the rays and for the hits
  if (between) {
    const MemoryClient client{*between, config_.interconnect.link_depth, RequesterKind::kRecords};
    records = memory_.add_cache_clients(core_number, std::array{client, client});
  }
  core.tni.make_cluster(machine_, memory_.cache_port_id(core_number), memory_.build_ports(core_number));
  if (!between) return;
  const MemoryPort &rays = records[0], &hits = records[1];
  machine_.build<MemoryInterface>(
      *between, direct, record_memory_of_core(config_, workload, core_number), rays.client,
      MemoryInterface::Rays::Links{wires.rays_from_srp, wires.rays_to_tni, rays.requests, rays.responses},
      MemoryInterface::Hits::Links{wires.hits_from_tni, wires.hits_to_srp, hits.requests, hits.responses}, l2_clock_);
}

sim::RunLimits Gpu::run_limits(sim::Time now) const {
  // After the last tile the run may end at any time, so no unit may run ahead.
  if (stopped_ || dispatcher_->is_done()) return {now, now};
  const Core& core = cores_.front();
  const sim::Time dispatch = machine_.wake_time(dispatcher_id_), next_tile = dispatch + core.tiles_in.latency();
  const sim::Time lookahead = std::min(machine_.min_lookahead(), core.tiles_in.latency() + core.tiles_out.latency());
  const sim::Time end = std::min(now + lookahead, next_tile);
  // A tile may end before the end of this lookahead, so the dispatcher must not tick ahead of the cores.
  return {dispatch, dispatcher_->has_more_tiles() ? end : std::min(end, earliest_end_of_last_tile(now))};
}

/// Returns a lower bound of the time at which the tile dispatcher is notified of the end of the last tile. Requires
/// that no tile is left to dispatch.
sim::Time Gpu::earliest_end_of_last_tile(sim::Time now) const {
  sim::Time at = now + cores_.front().tiles_out.latency();
  for (const Core& core : cores_) at = std::min(at, core.tiles_out.pop_at());
  if (builder_wires_) at = std::min(at, builder_wires_->done.pop_at());
  return at;
}

void Gpu::finish(sim::Time last_edge) {
  elapsed_ = tni_clock_.edge_at_or_after(last_edge + 1);
  machine_.finish(elapsed_);
}

std::vector<KernelUse> Gpu::kernel_use() const {
  std::vector<KernelUse> sum(kernel_schedules().size());
  for (const Core& core : cores_) {
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += core.srp->kernel_use()[k];
  }
  return sum;
}

std::uint64_t Gpu::warm_caches(const traces::TileWork& work, std::uint32_t core) {
  const Core& c = cores_[core];
  std::uint64_t filled = 0;
  const std::vector<Trv*>& trvs = c.tni.trvs();
  const Interleave banks = config_.l2.bank_interleave();
  const Interleave channels = config_.dram.channel_interleave();
  const auto second_level = [&](Addr line) {
    if (memory_.l2_banks()[banks.index_of(line)]->warm_line(line)) return;
    filled += 1;
    if (config_.slc.is_present()) memory_.system_cache_slices()[channels.index_of(line)]->warm_line(line);
  };
  for_each_line_of_tile(
      work, layout_, stored_samples_,
      [&](std::uint32_t ray, Addr line) {
        if (!trvs[ray % trvs.size()]->warm_line(line)) second_level(line);
      },
      [&](std::uint32_t ray, Addr line) {
        if (!c.tni.ist_of(ray % trvs.size()).warm_line(line)) second_level(line);
      },
      [&](Addr line) {
        if (!c.srp->warm_line(line)) second_level(line);
      });
  return filled;
}

void Gpu::invalidate_first_level() {
  if (tree_bytes_ == 0 && builder_ == nullptr) return;
  std::uint64_t lines = 0;
  for (const Core& core : cores_) {
    for (Trv* trv : core.tni.trvs()) lines += trv->clear_l1();
    for (Ist* ist : core.tni.ists()) lines += ist->clear_l1();
    lines += core.srp->clear_cache();
  }
  if (builder_ != nullptr) builder_->count_invalidated_lines(lines);
  // DMA engines write the trees of kernels to memory, around the L2.
  const Interleave banks = config_.l2.bank_interleave();
  for (Addr line = layout_.nodes; line < layout_.nodes + tree_bytes_; line += kLineBytes) {
    memory_.l2_banks()[banks.index_of(line)]->drop_line(line);
  }
}

CacheContents Gpu::cache_contents() const {
  CacheContents contents;
  for (const Core& core : cores_) {
    for (const Trv* trv : core.tni.trvs()) contents.first_level.push_back(trv->l1_tags());
    for (const Ist* ist : core.tni.ists()) contents.first_level.push_back(ist->l1_tags());
    contents.first_level.push_back(core.srp->cache_tags());
    if (core.raster != nullptr) contents.first_level.push_back(core.raster->l1_tags());
  }
  for (const L2Bank* bank : memory_.l2_banks()) contents.l2.push_back(bank->store());
  for (const SystemCacheSlice* slice : memory_.system_cache_slices()) contents.slc.push_back(slice->store());
  return contents;
}

void Gpu::set_cache_contents(const CacheContents& contents) {
  auto next = contents.first_level.begin();
  for (const Core& core : cores_) {
    for (Trv* trv : core.tni.trvs()) trv->set_l1_tags(*next++);
    for (Ist* ist : core.tni.ists()) ist->set_l1_tags(*next++);
    core.srp->set_cache_tags(*next++);
    if (core.raster != nullptr) core.raster->set_l1_tags(*next++);
  }
  for (std::size_t i = 0; i < contents.l2.size(); ++i) memory_.l2_banks()[i]->set_store(contents.l2[i]);
  for (std::size_t i = 0; i < contents.slc.size(); ++i) {
    memory_.system_cache_slices()[i]->set_store(contents.slc[i]);
  }
}

}  // namespace hw
