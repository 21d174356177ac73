#include "hw_models/frame/tile_dispatcher.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "sim/engine.h"

namespace hw {
namespace {

/// Source of tiles 0, 1, 2, ... without work. It tracks which tiles are in flight.
class EmptyTiles final : public TileSource {
 public:
  explicit EmptyTiles(std::uint32_t count) : works_(count) {
    for (std::uint32_t i = 0; i < count; ++i) works_[i].tile = i;
  }
  const traces::TileWork* next() override { return next_ == works_.size() ? nullptr : &works_[next_++]; }
  void release_work(const traces::TileWork* work) override {
    back.push_back(work->tile);
    works_[work->tile].tile = 0xffffffffU;  // the tile's storage may be reused now
  }
  traces::TileWork& work(std::uint32_t tile) { return works_[tile]; }
  std::vector<std::uint32_t> back;

 private:
  std::vector<traces::TileWork> works_;
  std::size_t next_ = 0;
};

/// Test harness for a tile dispatcher, with cores that keep each tile for a given time.
class DispatcherHarness {
 public:
  struct Setup {
    std::uint32_t tiles = 12;
    std::vector<std::uint32_t> hold = {50, 50};  ///< for each core: cycles that a tile stays there
    std::uint32_t tiles_per_core = 3;
    std::uint32_t tiles_in_pass = 3;
    std::vector<std::uint32_t> starts = {};  ///< for each core: first cycle in which it may get a tile; empty: 0
  };
  explicit DispatcherHarness(const Setup& setup) : source(setup.tiles) {
    const sim::UnitId dispatcher = machine_.unit({"dispatcher", clock_});
    TileDispatcher::Links links;
    for (std::size_t c = 0; c < setup.hold.size(); ++c) {
      const sim::UnitId core = machine_.unit({"core", clock_});
      auto& in = machine_.link<TileJob>(std::max(setup.tiles_per_core, setup.tiles_in_pass), 1, dispatcher, core);
      auto& out =
          machine_.link<TileDone>(std::max(setup.tiles_per_core, setup.tiles_in_pass), setup.hold[c], core, dispatcher);
      links.to_core.push_back(&in);
      links.from_core.push_back(&out);
      machine_.build<Core>(core, *this, c, in, out);
    }
    const sim::UnitId bank = machine_.unit({"bank", clock_});
    links.to_l2.push_back(&machine_.link<Flush>(1, 1, dispatcher, bank));
    machine_.build<Bank>(bank, flushes, *links.to_l2.back());
    dispatcher_ = &machine_.build<TileDispatcher>(
        dispatcher, source, TilesInFlight{setup.tiles_per_core, setup.tiles_in_pass}, links, clock_, setup.starts);
  }

  template <sim::Skip kSkip = sim::Skip::kOn>
  DispatcherHarness& run() {
    end_ = clock_.edge_after(sim::run<kSkip>(*this), 1);
    machine_.finish(end_);
    return *this;
  }
  sim::Machine& machine() { return machine_; }
  bool done() const { return dispatcher_->is_done(); }

  struct Arrival {
    std::size_t core;
    std::uint32_t tile;
    std::uint64_t cycle;
    friend bool operator==(const Arrival&, const Arrival&) = default;
  };
  std::vector<std::uint32_t> tiles_of(std::size_t core) const {
    std::vector<std::uint32_t> tiles;
    for (const Arrival& a : arrivals) {
      if (a.core == core) tiles.push_back(a.tile);
    }
    return tiles;
  }
  const TileDispatcher& dispatcher() const { return *dispatcher_; }
  std::uint64_t spent(TileDispatcher::CycleReason why) const {
    return clock_.cycles(dispatcher_->activity().spent(why));
  }
  std::uint64_t end() const { return clock_.cycles(end_); }

  EmptyTiles source;
  std::vector<Arrival> arrivals;
  std::uint32_t flushes = 0;  ///< flushes received before the last tile is finished

 private:
  struct Bank {
    Bank(std::uint32_t& counted, sim::Link<Flush>& from) : flushes(counted), in(from) {}
    sim::Time tick(sim::Time now) {
      if (in.can_pop(now)) {
        in.pop(now);
        flushes += 1;
      }
      return in.pop_at();
    }
    std::uint32_t& flushes;
    sim::Link<Flush>& in;
  };
  struct Core {
    Core(DispatcherHarness& b, std::size_t c, sim::Link<TileJob>& jobs, sim::Link<TileDone>& dones)
        : harness(b), index(c), in(jobs), out(dones) {}
    sim::Time tick(sim::Time now) {
      if (in.can_pop(now) && out.can_push(now)) {
        const TileJob job = in.pop(now);
        harness.arrivals.push_back({index, job.work->tile, harness.clock_.cycles(now)});
        out.push(now, {job.work});
      }
      return harness.clock_.edge_after(now, 1);
    }
    DispatcherHarness& harness;
    std::size_t index;
    sim::Link<TileJob>& in;
    sim::Link<TileDone>& out;
  };

  sim::Clock clock_{2'000'000};
  sim::Machine machine_;
  TileDispatcher* dispatcher_ = nullptr;
  sim::Time end_ = 0;
};

TEST(TileDispatcher, DispatchesATilePerCycleEachCoreInTurnUntilAllAreFull) {
  DispatcherHarness harness({.tiles = 12, .hold = {50, 50, 50}, .tiles_per_core = 2});
  harness.run();
  for (std::uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(harness.arrivals[i], (DispatcherHarness::Arrival{i % 3, i, 1 + i}));
  }
  // The first tile returns after its stay. The dispatcher sees that and dispatches the seventh in the same cycle.
  EXPECT_EQ(harness.arrivals[6].cycle, 1 + 50 + 1U);
}

TEST(TileDispatcher, FlushesTheL2WhenAllTilesHaveReturned) {
  DispatcherHarness harness({.tiles = 12});
  harness.run();
  EXPECT_EQ(harness.flushes, 0U);
  EXPECT_FALSE(harness.machine().is_drained()) << "it is on its way";
}

TEST(TileDispatcher, NoCoreGetsATileBeforeItsStart) {
  DispatcherHarness harness({.tiles = 12, .hold = {50, 50, 50}, .tiles_per_core = 1, .starts = {20, 0, 30}});
  harness.run();
  const std::uint64_t wire = 1;
  EXPECT_EQ(harness.arrivals[0], (DispatcherHarness::Arrival{1, 0, wire}));
  EXPECT_EQ(harness.arrivals[1], (DispatcherHarness::Arrival{0, 1, 20 + wire}));
  EXPECT_EQ(harness.arrivals[2], (DispatcherHarness::Arrival{2, 2, 30 + wire}));
}

TEST(TileDispatcher, NTilesOnOneCoreTakeNStaysOverTilesInFlight) {
  DispatcherHarness harness({.tiles = 30, .hold = {100}, .tiles_per_core = 3});
  harness.run();
  const std::uint64_t round = 100 + 1;  // a stay and the link in
  EXPECT_EQ(harness.end() - 1, 10 * round + 2) << "the third tile of a round comes two cycles after the first";
}

TEST(TileDispatcher, ASlowCoreGetsFewerTiles) {
  DispatcherHarness harness({.tiles = 60, .hold = {40, 400}, .tiles_per_core = 2});
  harness.run();
  EXPECT_GT(harness.tiles_of(0).size(), 5 * harness.tiles_of(1).size());
}

TEST(TileDispatcher, EveryTileIsDispatchedOnceInOrderAndReturns) {
  DispatcherHarness harness({.tiles = 40, .hold = {7, 13, 29}});
  harness.run();
  ASSERT_EQ(harness.arrivals.size(), 40U);
  for (std::uint32_t i = 0; i < 40; ++i) EXPECT_EQ(harness.arrivals[i].tile, i);
  std::vector<std::uint32_t> all(40);
  std::iota(all.begin(), all.end(), 0U);
  std::ranges::sort(harness.source.back);
  EXPECT_EQ(harness.source.back, all);
  EXPECT_EQ(harness.dispatcher().stats().dispatched, 40U);
  EXPECT_EQ(harness.dispatcher().stats().finished, 40U);
}

TEST(TileDispatcher, AnEmptyListIsDoneAtOnce) {
  DispatcherHarness harness({.tiles = 0});
  harness.run();
  EXPECT_EQ(harness.end(), 1U);
}

TEST(TileDispatcher, ATileAfterAllWaitsForEveryTileBeforeIt) {
  DispatcherHarness harness({.tiles = 8, .hold = {20, 90}, .tiles_per_core = 2});
  harness.source.work(4).after_all = true;
  harness.run();
  ASSERT_EQ(harness.arrivals.size(), 8U);
  EXPECT_EQ(harness.arrivals[3].cycle, 4U);
  // The fifth tile is dispatched in the cycle in which the dispatcher sees the end of the fourth.
  EXPECT_EQ(harness.arrivals[4].cycle, 4 + 90 + 1U) << "the fourth is the last to be back";
  EXPECT_EQ(harness.spent(TileDispatcher::CycleReason::kWaiting), 4 + 90 - 4U);
}

TEST(TileDispatcher, CoresHaveMoreTilesOfALaterPassAtOnce) {
  DispatcherHarness harness({.tiles = 14, .hold = {200}, .tiles_per_core = 2, .tiles_in_pass = 6});
  for (std::uint32_t t = 0; t < 14; ++t) harness.source.work(t).samples = 1;
  harness.source.work(6).after_all = true;
  harness.run();
  ASSERT_EQ(harness.arrivals.size(), 14U);
  EXPECT_GT(harness.arrivals[2].cycle, harness.arrivals[1].cycle + 100) << "two in the first pass";
  EXPECT_EQ(harness.arrivals[11].cycle, harness.arrivals[6].cycle + 5) << "six in the later one";
  EXPECT_GT(harness.arrivals[12].cycle, harness.arrivals[11].cycle + 100);
}

TEST(TileDispatcher, EveryCycleHasAReasonAndTheOracleAgrees) {
  for (const bool some_wait : {false, true}) {
    const DispatcherHarness::Setup setup{.tiles = 20, .hold = {9, 31}, .tiles_per_core = 2};
    DispatcherHarness fast(setup), oracle(setup);
    for (DispatcherHarness* harness : {&fast, &oracle}) {
      for (std::uint32_t t = 3; some_wait && t < 20; t += 3) harness->source.work(t).after_all = true;
    }
    fast.run();
    oracle.run<sim::Skip::kOff>();
    using CycleReason = TileDispatcher::CycleReason;
    std::uint64_t sum = 0;
    for (const CycleReason why :
         {CycleReason::kIdle, CycleReason::kDispatching, CycleReason::kCoresFull, CycleReason::kWaiting}) {
      EXPECT_EQ(fast.spent(why), oracle.spent(why));
      sum += fast.spent(why);
    }
    EXPECT_EQ(sum, fast.end());
    EXPECT_EQ(fast.spent(CycleReason::kDispatching), 20U);
    EXPECT_EQ(fast.spent(CycleReason::kWaiting) > 0, some_wait);
  }
}

}  // namespace
}  // namespace hw
