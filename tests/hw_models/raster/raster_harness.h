#pragma once
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/raster/raster_unit.h"
#include "sim/engine.h"

namespace hw::test {

using traces::RasterTriangle;
using traces::TileWork;
using traces::WorkNode;

/// Returns the work of a tile with a single node, whose triangles are in one triangle list.
inline TileWork tile_of(WorkNode::Kind kind, std::uint32_t items, const std::vector<RasterTriangle>& triangles,
                        std::uint32_t pixel_samples = 1) {
  TileWork work;
  work.raster_triangles = triangles;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::uint32_t entries = count;
  if (kind == WorkNode::Kind::kBin) {
    entries = 0;
    for (const RasterTriangle& t : triangles) entries += t.lists;
  }
  if (entries != 0) work.list_runs.push_back({0, entries});
  work.raster.push_back({0, count, 0, entries != 0 ? 1U : 0U, pixel_samples});
  work.nodes.push_back({.kind = kind, .items = items, .raster = 0, .inputs = {}});
  return work;
}

/// Returns `count` copies of the triangle `like`. They share its vertices, but each has its own cache line.
inline std::vector<RasterTriangle> triangles(std::uint32_t count, const RasterTriangle& like) {
  std::vector<RasterTriangle> all(count, like);
  for (std::uint32_t i = 0; i < count; ++i) all[i].number = 16 * i;
  return all;
}

inline TileWork wave(std::uint32_t count, std::uint32_t blocks, std::uint32_t quads, std::uint32_t samples = 64,
                     std::uint32_t pixel_samples = 1) {
  return tile_of(
      WorkNode::Kind::kRaster, samples,
      triangles(count,
                {.vertices = {0, 4, 8}, .blocks = blocks, .quads = quads, .samples = 4 * quads, .passed = quads}),
      pixel_samples);
}

inline TileWork batch(std::uint32_t count, std::uint32_t lists) {
  return tile_of(WorkNode::Kind::kBin, count, triangles(count, {.vertices = {0, 4, 8}, .lists = lists}));
}

/// Test harness for a rasteriser, with a core that sends jobs and a memory of fixed latency.
class RasterHarness {
 public:
  explicit RasterHarness(const RasterUnitConfig& config, bool ideal = true, std::uint32_t latency = 20)
      : from_memory_(machine_.link<MemResponse>(64, latency, memory_id_, unit_id_)),
        unit_(machine_.build<RasterUnit>(unit_id_, config, RasterMemory(1 << 20, {1 << 16, 1 << 16, 1 << 20}),
                                         RasterUnit::Links{jobs_, dones_, to_memory_, from_memory_}, std::uint16_t{3},
                                         clock_, ideal)) {
    machine_.build<Core>(core_id_, *this);
    machine_.build<Memory>(memory_id_, *this);
  }

  RasterHarness& add(const TileWork& work) {
    work_.push_back(&work);
    return *this;
  }
  template <sim::Skip kSkip = sim::Skip::kOn>
  RasterHarness& run() {
    end_ = clock_.edge_after(sim::run<kSkip>(*this), 1);
    machine_.finish(end_);
    return *this;
  }

  sim::Machine& machine() { return machine_; }
  bool done() const { return done_ == work_.size() && machine_.is_drained(); }
  std::uint64_t cycles() const { return clock_.cycles(done_at_); }
  std::uint64_t end() const { return clock_.cycles(end_); }
  const RasterStats& stats() const { return unit_.stats(); }
  std::uint64_t spent(RasterUnit::CycleReason why) const { return clock_.cycles(unit_.activity().spent(why)); }
  const std::vector<MemRequest>& written() const { return written_; }
  const std::vector<Addr>& read() const { return read_; }

 private:
  struct Core {
    explicit Core(RasterHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      if (sent < harness.work_.size() && harness.jobs_.can_push(now)) {
        harness.jobs_.push(now, {harness.work_[sent], 0, static_cast<std::uint32_t>(sent)});
        sent += 1;
      }
      if (harness.dones_.can_pop(now)) {
        EXPECT_EQ(harness.dones_.pop(now).tag, harness.done_) << "in their order";
        harness.done_ += 1;
        harness.done_at_ = now;
      }
      return harness.clock_.edge_after(now, 1);
    }
    RasterHarness& harness;
    std::size_t sent = 0;
  };
  struct Memory {
    explicit Memory(RasterHarness& b) : harness(b) {}
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
    RasterHarness& harness;
  };

  const sim::Clock clock_{2'000'000};
  sim::Machine machine_;
  const sim::UnitId unit_id_ = machine_.unit({"raster", clock_}), core_id_ = machine_.unit({"core", clock_}),
                    memory_id_ = machine_.unit({"memory", clock_});
  sim::Link<RasterJob>& jobs_ = machine_.link<RasterJob>(4, 1, core_id_, unit_id_);
  sim::Link<RasterDone>& dones_ = machine_.link<RasterDone>(8, 1, unit_id_, core_id_);
  sim::Link<MemRequest>& to_memory_ = machine_.link<MemRequest>(2, 1, unit_id_, memory_id_);
  sim::Link<MemResponse>& from_memory_;
  RasterUnit& unit_;
  std::vector<const TileWork*> work_;
  std::size_t done_ = 0;
  sim::Time done_at_ = 0, end_ = 0;
  std::vector<MemRequest> written_;
  std::vector<Addr> read_;
};

}  // namespace hw::test
