#include "tests/hw_models/srp/srp_harness.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace hw::test {

using traces::WorkNode;

SrpHarness::SrpHarness(const Setup& setup, const std::vector<Kernel>& kernels)
    : world_id_(machine_.unit({"world", clock_})),
      srp_id_(machine_.unit({"srp", clock_})),
      tiles_in_(machine_.link<TileJob>(setup.buffer.tiles_in_flight, 1, world_id_, srp_id_)),
      tiles_out_(
          machine_.link<TileDone>(setup.buffer.tiles_in_flight * (traces::kMostBorders + 1), 1, srp_id_, world_id_)),
      rays_out_(machine_.link<RayJob>(64, 1, srp_id_, world_id_)),
      hits_in_(machine_.link<RayDone>(1024, setup.tni_latency, world_id_, srp_id_)),
      memory_out_(machine_.link<MemRequest>(2, 1, srp_id_, world_id_)),
      memory_in_(machine_.link<MemResponse>(64, setup.memory_latency, world_id_, srp_id_)),
      dma_out_(machine_.link<DmaJob>(4, 1, srp_id_, world_id_)),
      dma_in_(machine_.link<DmaDone>(8, setup.dma_latency, world_id_, srp_id_)) {
  layout_.attributes = 0;
  layout_.materials = 1 << 20;
  for (const Kernel& kernel : kernels) {
    KernelSchedule& k = kernels_.emplace_back();
    k.ii = kernel.ii;
    k.depth = kernel.depth;
    k.config_reads = 16 * kernel.ii;
    k.queued_loads = 1;
    conflicts_.push_back(kernel.conflicts);
  }
  const Srp::Frame frame{.layout = &layout_,
                         .kernels = kernels_,
                         .conflicts = conflicts_,
                         .needs = {.tile_samples = setup.tile_samples, .wave_samples = setup.wave_samples},
                         .ray_interval = setup.ray_interval * clock_.period(),
                         .areas = kBases,
                         .ideal = setup.ideal,
                         .observer = setup.observer};
  machine_.build<World>(world_id_, *this);
  srp_ = &machine_.build<Srp>(
      srp_id_, setup.config, setup.buffer, frame,
      Srp::Links{tiles_in_, tiles_out_, rays_out_, hits_in_, memory_out_, memory_in_, dma_out_, dma_in_},
      std::uint16_t{0}, clock_);
}

SrpHarness& SrpHarness::add(traces::TileWork work, std::uint32_t missing) {
  works_.push_back(std::move(work));
  missing_.push_back(missing);
  return *this;
}

SrpHarness& SrpHarness::tell(std::uint64_t cycle, std::size_t tile, std::uint32_t missing) {
  news_.push_back({cycle, tile, missing});
  return *this;
}

sim::Time SrpHarness::World::tick(sim::Time now) {
  SrpHarness& b = harness;
  const std::uint64_t cycle = b.clock_.cycles(now);
  if (tiles_sent < b.works_.size() && b.tiles_in_.can_push(now)) {
    b.tiles_in_.push(now, {&b.works_[tiles_sent], b.missing_[tiles_sent]});
    tiles_sent += 1;
  }
  for (const News& n : b.news_) {
    if (n.cycle == cycle) b.tiles_in_.push(now, {&b.works_[n.tile], n.missing});
  }
  if (b.tiles_out_.can_pop(now)) {
    const TileDone done = b.tiles_out_.pop(now);
    if (done.border != traces::WorkNode::kNone) {
      b.borders_.push_back({done.work->tile, done.border});
    } else {
      b.tiles_done_.push_back(done.work->tile);
      b.done_at_.push_back(cycle);
    }
  }
  if (b.rays_out_.can_pop(now)) {
    const std::uint32_t id = b.rays_out_.pop(now).id;
    b.rays_.push_back({cycle, id >> 24, id & 0xffffffU});
    b.hits_in_.push(now, {id});
  }
  if (b.memory_out_.can_pop(now)) {
    const MemRequest r = b.memory_out_.pop(now);
    b.memory_in_.push(now, {r.line, r.source, r.tag});
  }
  if (b.dma_out_.can_pop(now) && b.dma_in_.can_push(now)) {
    b.transfers_.push_back(b.dma_out_.pop(now));
    b.dma_in_.push(now, {b.transfers_.back().tag});
  }
  sim::Time at = std::min({b.tiles_out_.pop_at(), b.rays_out_.pop_at(), b.memory_out_.pop_at(), b.dma_out_.pop_at()});
  if (tiles_sent < b.works_.size()) at = std::min(at, b.tiles_in_.push_at());
  for (const News& n : b.news_) {
    if (n.cycle > cycle) at = std::min(at, b.clock_.edge_after(0, n.cycle));
  }
  return at == sim::kNever ? at : std::max(b.clock_.edge_after(now, 1), at);
}

TileBuilder::Node TileBuilder::add(WorkNode::Kind kind, std::uint32_t items, std::vector<Edge> inputs) {
  WorkNode& node = work_.nodes.emplace_back();
  node.kind = kind;
  node.items = items;
  node.inputs = std::move(inputs);
  return static_cast<Node>(work_.nodes.size() - 1);
}

TileBuilder::Node TileBuilder::launch(traces::KernelId kernel, std::uint32_t items, std::vector<Edge> inputs) {
  const Node node = add(WorkNode::Kind::kLaunch, items, std::move(inputs));
  work_.nodes[node].kernel = kernel;
  return node;
}

TileBuilder::Node TileBuilder::launch(traces::KernelId kernel, const std::vector<std::vector<traces::Access>>& accesses,
                                      std::vector<Edge> inputs) {
  const Node node = launch(kernel, static_cast<std::uint32_t>(accesses.size()), std::move(inputs));
  work_.nodes[node].has_accesses = true;
  work_.nodes[node].first = static_cast<std::uint32_t>(work_.access_begin.size());
  for (const auto& item : accesses) {
    work_.access_begin.push_back(static_cast<std::uint32_t>(work_.accesses.size()));
    work_.accesses.insert(work_.accesses.end(), item.begin(), item.end());
  }
  return node;
}

TileBuilder::Node TileBuilder::rays(Node launch, std::uint32_t count, std::vector<std::uint32_t> sources) {
  const Node node = add(WorkNode::Kind::kRays, count, {each(launch)});
  work_.nodes[node].first = static_cast<std::uint32_t>(work_.ray_begin.size());
  work_.ray_begin.resize(work_.ray_begin.size() + count);
  if (!sources.empty()) map(node, sources);
  return node;
}

TileBuilder& TileBuilder::map(Node node, const std::vector<std::uint32_t>& sources) {
  work_.nodes[node].sources = static_cast<std::uint32_t>(work_.sources.size());
  work_.sources.insert(work_.sources.end(), sources.begin(), sources.end());
  return *this;
}

TileBuilder::Node TileBuilder::transfer(traces::Region region, bool to_memory, std::uint32_t bytes,
                                        std::vector<Edge> inputs, std::uint64_t offset) {
  const Node node = add(WorkNode::Kind::kTransfer, bytes, std::move(inputs));
  work_.nodes[node].region = region;
  work_.nodes[node].to_memory = to_memory;
  work_.nodes[node].offset = offset;
  return node;
}

TileBuilder::Node TileBuilder::import_border(traces::Border border, std::uint32_t bytes) {
  const Node node = transfer(traces::Region::kSamples, false, bytes);
  work_.nodes[node].border = static_cast<std::uint32_t>(work_.imports.size());
  work_.imports.push_back(border);
  return node;
}

TileBuilder::Node TileBuilder::export_border(std::uint32_t number, std::uint32_t bytes, std::vector<Edge> inputs) {
  const Node node = transfer(traces::Region::kSamples, true, bytes, std::move(inputs));
  work_.nodes[node].border = number;
  return node;
}

traces::TileWork TileBuilder::build() {
  work_.access_begin.push_back(static_cast<std::uint32_t>(work_.accesses.size()));
  work_.walk.push_back(0);
  return work_;
}

traces::TileWork trace_and_shade(std::uint32_t items, std::uint32_t tile, bool reads_first) {
  TileBuilder work(tile);
  std::vector<traces::Edge> inputs;
  if (reads_first) inputs.push_back(TileBuilder::all(work.transfer(traces::Region::kRates, false, 64)));
  work.launch(kB, items, {TileBuilder::each(work.rays(work.launch(kA, items, inputs), items))});
  return work.build();
}

void expect_equal_cycles(const SrpHarness& fast, const SrpHarness& oracle) {
  EXPECT_EQ(fast.elapsed(), oracle.elapsed());
  std::uint64_t sum = 0;
  for (std::size_t w = 0; w < static_cast<std::size_t>(Srp::CycleReason::kCount); ++w) {
    const auto why = static_cast<Srp::CycleReason>(w);
    EXPECT_EQ(fast.spent(why), oracle.spent(why)) << Srp::kReasons[w].name;
    sum += fast.spent(why);
  }
  EXPECT_EQ(sum, fast.elapsed());
}

}  // namespace hw::test
