#pragma once
#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <vector>

#include "hw_models/tni/tni_core.h"
#include "sim/engine.h"
#include "sim/link.h"
#include "traces/walk.h"

namespace hw::test {

/// Test harness for a T&I unit: a source of rays, a memory with a fixed latency, and a sink of hits.
class TniHarness {
 public:
  struct Setup {
    TniConfig config;
    std::uint32_t memory_latency = 50;  ///< cycles from a memory request to the arrival of its line
    std::vector<std::uint32_t> parents;
    std::vector<std::array<std::uint32_t, 2>> single_boxes;
    std::vector<traces::NodeRecord> links;
    std::vector<traces::InstanceRecord> placed;
    std::uint32_t node_bytes = 64;
    std::uint32_t triangle_bytes = 48;
    bool hybrid = false;
    // Wide nodes and leaf records of several triangles (tree_in_memory.h).
    TreeKind kind;
    std::vector<WideRecord> wide;
    std::vector<traces::WideNode> wide_links;
    std::vector<std::uint32_t> triangle_places;
    bool decoded = false;
    bool parents_in_nodes = false;
    TniCore::Ideal ideal;
    std::uint32_t fifo = 64;
    std::uint32_t hit_interval = 1;
    std::uint32_t drain_every = 1;  ///< cycles between two hits that the sink accepts
  };

  explicit TniHarness(const Setup& setup)
      : setup_(setup),
        source_id_(machine_.unit({"source", clock_})),
        memory_id_(machine_.unit({"memory", clock_})),
        tni_(machine_, setup.config, setup.ideal, 0, clock_, setup.kind),
        rays_in_(machine_.link<RayJob>(setup.fifo, 1, source_id_, tni_.rays_in_id())),
        hits_out_(machine_.link<RayDone>(setup.fifo, 1, tni_.dispatcher_id(), source_id_)) {
    for (const MemoryClient& client : tni_.memory_clients()) {
      ports_.push_back({machine_.link<MemRequest>(4, 1, client.unit, memory_id_),
                        machine_.link<MemResponse>(64, setup.memory_latency, memory_id_, client.unit),
                        static_cast<std::uint16_t>(ports_.size())});
    }
    machine_.build<Source>(source_id_, *this);
    machine_.build<Memory>(memory_id_, *this);
    TreeInMemory tree{0,       setup.node_bytes, setup_.parents, setup_.single_boxes, setup.hybrid, setup_.links,
                      1 << 19, setup_.placed};
    tree.kind = setup.kind;
    if (setup.kind.wide) tree.wide = std::make_shared<const std::vector<WideRecord>>(setup.wide);
    tree.wide_nodes_have_lines =
        std::ranges::any_of(setup.wide, [](const WideRecord& record) { return record.lines > 1; });
    tree.wide_links = setup_.wide_links;
    tree.parent_links = 1 << 22;
    tree.parents_in_nodes = setup.parents_in_nodes;
    tni_.build_units(machine_, {tree, {1 << 20, setup.triangle_bytes, setup_.triangle_places, setup.decoded}},
                     setup.hit_interval, {rays_in_, hits_out_, ports_});
  }

  TniHarness& add(std::vector<std::uint32_t> walk, std::uint32_t times = 1, std::uint32_t key = 0) {
    walks_.push_back(std::move(walk));
    for (std::uint32_t i = 0; i < times; ++i) {
      to_send_.push_back(RayJob{walks_.back().data(), static_cast<std::uint32_t>(to_send_.size()), kNoTile, key});
    }
    return *this;
  }

  // Called by the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const {
    return arrived_.size() == to_send_.size() &&
           std::ranges::all_of(tni_.trvs(), [](const Trv* trv) { return trv->idle(); }) &&
           std::ranges::all_of(tni_.ists(), [](const Ist* ist) { return ist->idle(); });
  }

  template <sim::Skip kSkip = sim::Skip::kOn>
  TniHarness& run() {
    return end(sim::run<kSkip>(*this));
  }
  TniHarness& run_shuffled(std::uint64_t seed) { return end(sim::run_shuffled(*this, seed)); }

  /// Returns the latency of a ray in cycles, from the arrival at the unit to the acceptance of its hit.
  std::uint64_t latency(std::size_t ray) const { return clock_.cycles(arrived_at_[ray] - sent_at_[ray]); }
  /// Returns the cycles between the hits of the first two rays.
  std::uint64_t gap() const { return clock_.cycles(arrived_at_[1] - arrived_at_[0]); }
  std::uint64_t span() const { return clock_.cycles(last_ - sent_at_.front()); }
  const TniCore& tni() const { return tni_; }
  const std::vector<std::uint32_t>& arrived() const { return arrived_; }
  std::uint64_t lines_requested() const { return lines_asked_; }
  const sim::Clock& clock() const { return clock_; }
  sim::Time end_time() const { return end_; }

 private:
  struct Memory {
    explicit Memory(TniHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      const sim::Time next = harness.clock_.edge_after(now, 1);
      sim::Time at = sim::kNever;
      for (const MemoryPort& port : harness.ports_) {
        if (port.requests.can_pop(now) && port.responses.can_push(now)) {
          const MemRequest r = port.requests.pop(now);
          port.responses.push(now, MemResponse{r.line, r.source, r.tag});
          harness.lines_asked_ += 1;
        }
        at = std::min(at, std::max({next, port.requests.pop_at(), port.responses.push_at()}));
      }
      return at;
    }
    TniHarness& harness;
  };
  struct Source {
    explicit Source(TniHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      TniHarness& b = harness;
      if (b.sent_ < b.to_send_.size() && b.rays_in_.can_push(now)) {
        b.rays_in_.push(now, b.to_send_[b.sent_++]);
        b.sent_at_.push_back(b.clock_.edge_after(now, 1));
      }
      if (now >= b.drain_at_ && b.hits_out_.can_pop(now)) {
        const std::uint32_t id = b.hits_out_.pop(now).id;
        b.arrived_.push_back(id);
        b.arrived_at_.resize(b.to_send_.size());
        b.arrived_at_[id] = now;
        b.last_ = now;
        b.drain_at_ = b.clock_.edge_after(now, b.setup_.drain_every);
      }
      const sim::Time next = b.clock_.edge_after(now, 1);
      sim::Time at = std::max({next, b.hits_out_.pop_at(), b.drain_at_});
      if (b.sent_ < b.to_send_.size()) at = std::min(at, std::max(next, b.rays_in_.push_at()));
      return at;
    }
    TniHarness& harness;
  };

  TniHarness& end(sim::Time last) {
    end_ = clock_.edge_after(last, 1);
    machine_.finish(end_);
    return *this;
  }

  Setup setup_;
  sim::Clock clock_{2'000'000};
  sim::Machine machine_;
  const sim::UnitId source_id_, memory_id_;
  TniCore tni_;
  sim::Link<RayJob>& rays_in_;
  sim::Link<RayDone>& hits_out_;
  std::vector<MemoryPort> ports_;
  std::deque<std::vector<std::uint32_t>> walks_;
  std::vector<RayJob> to_send_;
  std::size_t sent_ = 0;
  std::vector<sim::Time> sent_at_, arrived_at_;
  std::vector<std::uint32_t> arrived_;
  sim::Time drain_at_ = 0, last_ = 0, end_ = 0;
  std::uint64_t lines_asked_ = 0;
};

/// Returns the setup of a T&I unit with one traversal unit.
inline TniHarness::Setup one_trv() {
  TniHarness::Setup s;
  s.config.trvs = 1;
  return s;
}

inline const Trv& trv(const TniHarness& harness) { return *harness.tni().trvs().front(); }

/// Cycles that a ray spends on links: to the traversal unit, back to the dispatcher, and to the hit FIFO.
inline constexpr std::uint64_t kWires = 3;

/// Cycles of a node visit (fetch 2, box test 12), of a miss (1 to memory, 50 back; the fill probes again in the same
/// cycle) and of a pop. kPeriod: clock period in fs.
inline constexpr std::uint64_t kVisit = 14, kMiss = 51, kPop = 2, kPeriod = 2'000'000;

/// Returns the cycles of a single ray in an idle unit with warm caches.
inline std::uint64_t alone(TniHarness::Setup setup, const std::vector<std::uint32_t>& walk) {
  setup.config.trv.rays = 1;
  TniHarness harness(setup);
  return harness.add(walk, 2).run().gap() - (kWires - 1);
}

}  // namespace hw::test
