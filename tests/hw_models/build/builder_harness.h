#pragma once
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/build/tree_builder.h"
#include "sim/engine.h"

namespace hw::test {

using traces::BuildWork;
using traces::TileWork;
using traces::WorkNode;

inline constexpr Addr kTree = 1 << 20, kArrays = 1 << 24;
inline constexpr traces::BuildArraySizes kSizes{.vertices = 1 << 16, .triangles = 1 << 16, .instances = 1 << 10};

/// Returns a tree over a strip of triangles, with one node less than triangles. The leaves reverse the input's order.
inline TileWork strip(std::uint32_t triangles, bool refit = false) {
  TileWork work;
  const std::uint64_t nodes = std::uint64_t{64} * (triangles - 1), leaves = std::uint64_t{48} * triangles;
  work.build.push_back({.refit = refit, .output = {{{0, nodes}, {1 << 22, leaves}, {}}}});
  for (std::uint32_t i = 0; i < triangles; ++i) {
    work.build_triangles.push_back({i, i + 1, i + 2});
    work.build_order.push_back(triangles - 1 - i);
  }
  work.nodes.push_back({.kind = WorkNode::Kind::kBuild, .items = triangles, .first = 0, .inputs = {}});
  return work;
}

/// Test harness for a tree builder, with a dispatcher that sends trees and a memory of fixed latency.
class BuilderHarness {
 public:
  explicit BuilderHarness(const TreeBuilderConfig& config, bool ideal = false, std::uint32_t latency = 20,
                          Observer* observer = nullptr)
      : memory_map_(kArrays, kTree, kSizes, config.record_bytes),
        from_memory_(machine_.link<MemResponse>(64, latency, memory_id_, unit_id_)),
        unit_(machine_.build<TreeBuilder>(unit_id_, config, memory_map_,
                                          TreeBuilder::Links{jobs_, dones_, to_memory_, from_memory_, observer},
                                          std::uint16_t{3}, clock_, ideal)) {
    machine_.build<Dispatcher>(dispatcher_id_, *this);
    machine_.build<Memory>(memory_id_, *this);
  }

  BuilderHarness& add(const TileWork& work) {
    work_.push_back(&work);
    return *this;
  }
  template <sim::Skip kSkip = sim::Skip::kOn>
  BuilderHarness& run() {
    end_ = clock_.edge_after(sim::run<kSkip>(*this), 1);
    machine_.finish(end_);
    return *this;
  }

  sim::Machine& machine() { return machine_; }
  bool done() const { return done_ == work_.size() && machine_.is_drained(); }
  std::uint64_t cycles() const { return clock_.cycles(done_at_); }
  std::uint64_t end() const { return clock_.cycles(end_); }
  const TreeBuilderStats& stats() const { return unit_.stats(); }
  std::uint64_t spent(TreeBuilder::CycleReason why) const { return clock_.cycles(unit_.activity().spent(why)); }
  const std::vector<MemRequest>& written() const { return written_; }
  const std::vector<Addr>& read() const { return read_; }
  const BuildMemory& memory_map() const { return memory_map_; }

 private:
  struct Dispatcher {
    explicit Dispatcher(BuilderHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      if (sent < harness.work_.size() && harness.jobs_.can_push(now)) {
        harness.jobs_.push(now, {harness.work_[sent], 0, static_cast<TileTag>(sent)});
        sent += 1;
      }
      if (harness.dones_.can_pop(now)) {
        EXPECT_EQ(harness.dones_.pop(now).tile, harness.done_) << "in their order";
        harness.done_ += 1;
        harness.done_at_ = now;
      }
      return harness.clock_.edge_after(now, 1);
    }
    BuilderHarness& harness;
    std::size_t sent = 0;
  };
  struct Memory {
    explicit Memory(BuilderHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      if (harness.to_memory_.can_pop(now) && harness.from_memory_.can_push(now)) {
        const MemRequest r = harness.to_memory_.pop(now);
        EXPECT_EQ(r.source, 3);
        if (r.write) {
          harness.written_.push_back(r);
        } else {
          harness.read_.push_back(r.line);
          harness.from_memory_.push(now, {r.line, r.source, r.tag});
        }
      }
      return harness.clock_.edge_after(now, 1);
    }
    BuilderHarness& harness;
  };

  const sim::Clock clock_{2'000'000};
  const BuildMemory memory_map_;
  sim::Machine machine_;
  const sim::UnitId unit_id_ = machine_.unit({"builder", clock_}),
                    dispatcher_id_ = machine_.unit({"dispatcher", clock_}),
                    memory_id_ = machine_.unit({"memory", clock_});
  sim::Link<TileJob>& jobs_ = machine_.link<TileJob>(4, 1, dispatcher_id_, unit_id_);
  sim::Link<TileDone>& dones_ = machine_.link<TileDone>(8, 1, unit_id_, dispatcher_id_);
  sim::Link<MemRequest>& to_memory_ = machine_.link<MemRequest>(2, 1, unit_id_, memory_id_);
  sim::Link<MemResponse>& from_memory_;
  TreeBuilder& unit_;
  std::vector<const TileWork*> work_;
  std::size_t done_ = 0;
  sim::Time done_at_ = 0, end_ = 0;
  std::vector<MemRequest> written_;
  std::vector<Addr> read_;
};

}  // namespace hw::test
