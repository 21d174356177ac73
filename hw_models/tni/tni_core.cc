#include "hw_models/tni/tni_core.h"

#include <memory>
#include <string>
#include <utility>

#include "sim/error.h"

namespace hw {
namespace {

/// Returns the configuration of a T&I unit with ideal pipes. Miss handling is `reorder`, so that no ray delays another.
TniConfig with_ideal_pipes(TniConfig config) {
  constexpr std::uint32_t kMost = 64;
  config.link_depth = kMost;
  config.miss_handling = MissHandling::kReorder;
  config.trv.rays = config.ist.leaves = kMost;
  config.trv.box_latency = config.trv.leaf_latency = config.trv.stack_latency = 1;
  config.trv.transform_latency = 1;
  config.trv.decode_latency = config.trv.order_latency = 0;
  config.ist.decode_interval = 1;
  config.ist.distance_stage = config.ist.barycentric_stage = config.ist.latency = 1;
  config.trv.l1.hit_cycles = config.ist.l1.hit_cycles = 0;
  config.predictor.latency = 1;
  return config;
}

/// The links between a traversal unit and its intersection unit.
struct LeafLinks {
  sim::Link<LeafJob>* jobs;
  sim::Link<LeafDone>* answers;
  sim::Link<LeafPrefetch>* prefetches;  ///< null if leaves are not prefetched
};

}  // namespace

sim::UnitId declare_ist(sim::Machine& machine, const TniConfig& config, std::uint32_t core, sim::Clock clock,
                        const TreeKind& tree, std::uint32_t number) {
  const std::string suffix = config.ists == 1 ? "" : std::to_string(number);
  return machine.unit({unit_name_in_core(Ist::kName, core) + suffix, clock, core + 1, config.ist_sram_bytes(),
                       config.ist.l1.size.bytes, config.ist.parts(tree)});
}

TniCore::TniCore(sim::Machine& machine, const TniConfig& config, const Ideal& ideal, std::uint32_t core,
                 sim::Clock clock, const TreeKind& tree)
    : config_(ideal.tni ? with_ideal_pipes(config) : config),
      ideal_(ideal),
      dispatcher_id_(machine.unit({unit_name_in_core(RayDispatcher::kName, core), clock, core + 1,
                                   config.dispatcher.sram_bytes(), 0, config.dispatcher.parts()})) {
  for (std::uint32_t i = 0; i < config.ists; ++i) {
    ist_ids_.push_back(declare_ist(machine, config, core, clock, tree, i));
  }
  for (std::uint32_t t = 0; t < config.trvs; ++t) {
    trv_ids_.push_back(machine.unit({unit_name_in_core(Trv::kName, core) + std::to_string(t), clock, core + 1,
                                     config.trv_sram_bytes(tree), config.trv.l1.size.bytes, config.trv.parts(tree)}));
  }
  if (config.predictor.enabled) {
    predictor_id_ =
        machine.unit({unit_name_in_core(PredictorStage::kName, core), clock, core + 1, config.predictor.sram_bytes()});
  }
}

std::vector<MemoryClient> TniCore::memory_clients() const {
  std::vector<MemoryClient> all;
  for (const sim::UnitId trv : trv_ids_) all.push_back({trv, config_.trv.l1.mshrs, RequesterKind::kNodes});
  for (const sim::UnitId ist : ist_ids_) all.push_back({ist, config_.ist.l1.mshrs, RequesterKind::kTriangles});
  return all;
}

void TniCore::build_units(sim::Machine& machine, const Scene& scene, std::uint32_t hit_interval, const Links& links) {
  const TrvConfig& trv_config = config_.trv;
  const std::uint32_t pipe = trv_config.l1.hit_cycles + trv_config.visit_latency(scene.tree.kind) +
                             trv_config.most_passes(scene.tree.kind) - 1;
  if (pipe > kLongestPipe) {
    throw sim::InputError("tni.trv.box_latency: node fetch, decoding, box tests and ordering of a node take " +
                          std::to_string(pipe) + " cycles; allowed: 1 to " + std::to_string(kLongestPipe));
  }
  const TniMode mode{config_.miss_handling, config_.rau, ideal_.tni, ideal_.l1};
  const sim::Clock clock = dispatcher_id_.clock;
  const bool prefetches_leaves = config_.trv.has_prefetch_queue() && config_.ist.l1.mshrs >= 2;
  const std::uint32_t depth = config_.link_depth, leaf_latency = config_.trv.leaf_latency;
  sim::Link<RayJob>* rays = &links.rays_in;
  if (predictor_id_) {
    const std::uint32_t latency = config_.predictor.latency;
    rays = &machine.link<RayJob>(latency + depth, latency, *predictor_id_, dispatcher_id_);
    predictor_ =
        &machine.build<PredictorStage>(*predictor_id_, ideal_.tni, PredictorStage::Links{links.rays_in, *rays}, clock);
  }
  RayDispatcher::Links dispatcher{*rays, links.hits_out, {}, {}};
  std::vector<LeafLinks> leaves;
  for (std::size_t t = 0; t < trv_ids_.size(); ++t) {
    const sim::UnitId trv = trv_ids_[t], ist = ist_ids_[t % ist_ids_.size()];
    dispatcher.to_trv.push_back(&machine.link<RayJob>(depth, 1, dispatcher_id_, trv));
    dispatcher.from_trv.push_back(&machine.link<RayDone>(depth, 1, trv, dispatcher_id_));
    leaves.push_back(
        {&machine.link<LeafJob>(leaf_latency + depth, leaf_latency, trv, ist),
         &machine.link<LeafDone>(config_.trv.rays, 1, ist, trv),
         prefetches_leaves ? &machine.link<LeafPrefetch>(leaf_latency + depth, leaf_latency, trv, ist) : nullptr});
  }
  dispatcher_ = &machine.build<RayDispatcher>(
      dispatcher_id_,
      RayDispatcher::Policy{config_.dispatch, config_.trv.rays, hit_interval, ideal_.tni, config_.dispatcher},
      dispatcher, clock);
  std::shared_ptr<const Treelets> treelets;
  if (config_.trv.prefetch == Prefetch::kTreelet)
    treelets = std::make_shared<const Treelets>(scene.tree, scene.triangles, config_.trv.treelet_bytes.bytes,
                                                scene.tree.treelet_map(config_.trv.stack));
  for (std::size_t t = 0; t < trv_ids_.size(); ++t) {
    const MemoryPort& memory = links.memory[t];
    trvs_.push_back(
        &machine.build<Trv>(trv_ids_[t], config_.trv, mode, scene.tree, treelets,
                            Trv::Links{*dispatcher.to_trv[t], *dispatcher.from_trv[t], *leaves[t].jobs,
                                       *leaves[t].answers, memory.requests, memory.responses, leaves[t].prefetches},
                            memory.client, clock));
  }
  for (std::size_t i = 0; i < ist_ids_.size(); ++i) {
    const MemoryPort& memory = links.memory[trv_ids_.size() + i];
    Ist::Links ist{{}, {}, memory.requests, memory.responses};
    for (std::size_t t = i; t < leaves.size(); t += ist_ids_.size()) {
      ist.leaves_in.push_back(leaves[t].jobs);
      ist.leaves_out.push_back(leaves[t].answers);
      if (leaves[t].prefetches != nullptr) ist.prefetches_in.push_back(leaves[t].prefetches);
    }
    ists_.push_back(
        &machine.build<Ist>(ist_ids_[i], config_.ist, mode, scene.triangles, std::move(ist), memory.client, clock));
  }
}

void TniCore::make_cluster(sim::Machine& machine, sim::UnitId port_id, CorePort& port) {
  std::vector<sim::UnitId> units{dispatcher_id_, ist_ids_.front()};
  units.insert(units.end(), trv_ids_.begin(), trv_ids_.end());
  units.insert(units.end(), ist_ids_.begin() + 1, ist_ids_.end());
  if (port_id.clock == dispatcher_id_.clock) {
    port_ = &port;
    units.push_back(port_id);
  }
  machine.set_cluster(units, *this);
}

void TniCore::tick_more_ists_and_port(std::uint64_t due, sim::Time* wakes, const Cycle& cycle) {
  const std::size_t more = ists_.size() - 1;
  for (std::size_t i = 0; i < more; ++i) {
    if ((due >> i & 1U) != 0) wakes[i] = ists_[1 + i]->tick(cycle);
  }
  if (due >> more != 0) wakes[more] = port_->tick(cycle.now);
}

void TniCore::run(const sim::ClusterTurn& turn, sim::Time now) {
  const std::size_t trvs = trvs_.size();
  const std::uint64_t all_trvs = first_slots_mask(static_cast<std::uint32_t>(trvs));
  sim::Time* const wakes = turn.wakeup_times;
  Cycle cycle(now, dispatcher_id_.clock);
  for (;;) {
    // No unit can wake another unit in the same cycle, so the due units are determined once.
    const std::uint64_t due = sim::WakeupTable::due_mask(wakes, turn.group_minima.size(), cycle.now);
    if ((due & 1U) != 0) wakes[0] = dispatcher_->tick(cycle.now);
    if ((due & 2U) != 0) wakes[1] = ists_[0]->tick(cycle);
    Trv::tick_due(trvs_, due >> 2 & all_trvs, &wakes[2], cycle);
    if ((due >> 2 & ~all_trvs) != 0) {
      if (ists_.size() == 1) {
        wakes[2 + trvs] = port_->tick(cycle.now);
      } else {
        tick_more_ists_and_port(due >> (2 + trvs), &wakes[2 + trvs], cycle);
      }
    }
    const sim::Time soonest = sim::WakeupTable::refresh_group_minima(wakes, turn.group_minima);
    if (!turn.includes_time(soonest)) return;
    cycle.advance_to(soonest, dispatcher_id_.clock);
  }
}

}  // namespace hw
