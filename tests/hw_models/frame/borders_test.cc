#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/frame/tile_dispatcher.h"
#include "sim/engine.h"

// Tests of borders that tiles import: which cores get updates on missing borders, and when.

namespace hw {
namespace {

class ImportingTiles final : public TileSource {
 public:
  explicit ImportingTiles(const std::vector<std::vector<traces::Border>>& imports) : works_(imports.size()) {
    for (std::uint32_t i = 0; i < works_.size(); ++i) {
      works_[i].tile = i;
      works_[i].imports = imports[i];
    }
  }
  const traces::TileWork* next() override { return next_ == works_.size() ? nullptr : &works_[next_++]; }
  void release_work(const traces::TileWork*) override {}
  const traces::TileWork& work(std::uint32_t tile) const { return works_[tile]; }

 private:
  std::vector<traces::TileWork> works_;
  std::size_t next_ = 0;
};

constexpr std::uint32_t kWhole = traces::WorkNode::kNone;

/// Test harness for a tile dispatcher, with two cores that accept everything and send scripted messages. Links take one
/// cycle each way.
class BorderHarness {
 public:
  struct Said {
    std::uint64_t cycle = 0;
    std::size_t core = 0;
    std::uint32_t tile = 0, border = kWhole;
  };
  struct Heard {
    std::uint64_t cycle = 0;
    std::size_t core = 0;
    std::uint32_t tile = 0, missing = 0;
    friend bool operator==(const Heard&, const Heard&) = default;
  };

  BorderHarness(const std::vector<std::vector<traces::Border>>& imports, std::vector<Said> script,
                std::uint32_t tiles_per_core = 2)
      : tiles_(imports), script_(std::move(script)) {
    const sim::UnitId dispatcher = machine_.unit({"dispatcher", clock_});
    const sim::UnitId cores = machine_.unit({"cores", clock_});
    TileDispatcher::Links links;
    for (std::size_t c = 0; c < 2; ++c) {
      links.to_core.push_back(in_[c] = &machine_.link<TileJob>(tiles_per_core, 1, dispatcher, cores));
      links.from_core.push_back(
          out_[c] = &machine_.link<TileDone>(TileDispatcher::max_messages(tiles_per_core), 1, cores, dispatcher));
    }
    dispatcher_ = &machine_.build<TileDispatcher>(dispatcher, tiles_, TilesInFlight{tiles_per_core, tiles_per_core},
                                                  links, clock_);
    machine_.build<Cores>(cores, *this);
  }
  template <sim::Skip kSkip = sim::Skip::kOn>
  BorderHarness& run() {
    end_ = clock_.edge_after(sim::run<kSkip>(*this), 1);
    machine_.finish(end_);
    return *this;
  }
  sim::Machine& machine() { return machine_; }
  bool done() const { return dispatcher_->is_done(); }

  const TileDispatcher& dispatcher() const { return *dispatcher_; }
  std::uint64_t end() const { return clock_.cycles(end_); }
  std::vector<Heard> heard;

 private:
  struct Cores {
    explicit Cores(BorderHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      BorderHarness& b = harness;
      const std::uint64_t cycle = b.clock_.cycles(now);
      for (std::size_t c = 0; c < 2; ++c) {
        if (!b.in_[c]->can_pop(now)) continue;
        const TileJob job = b.in_[c]->pop(now);
        b.heard.push_back({cycle, c, job.work->tile, job.missing});
      }
      for (const Said& s : b.script_) {
        if (s.cycle == cycle) b.out_[s.core]->push(now, {&b.tiles_.work(s.tile), s.border});
      }
      return b.clock_.edge_after(now, 1);
    }
    BorderHarness& harness;
  };

  const sim::Clock clock_{2'000'000};
  sim::Machine machine_;
  ImportingTiles tiles_;
  const std::vector<Said> script_;
  std::array<sim::Link<TileJob>*, 2> in_{};
  std::array<sim::Link<TileDone>*, 2> out_{};
  TileDispatcher* dispatcher_ = nullptr;
  sim::Time end_ = 0;
};

using Heard = BorderHarness::Heard;

TEST(Borders, ATileWithAMissingBorderIsDispatchedAtOnceAndUpdatedAfterTheWrite) {
  BorderHarness harness({{}, {{0, 3}}}, {{20, 0, 0, 3}, {30, 0, 0}, {40, 1, 1}});
  harness.run();
  const std::vector<Heard> expected = {{1, 0, 0, 0}, {2, 1, 1, 1}, {22, 1, 1, 0}};
  EXPECT_EQ(harness.heard, expected);
  EXPECT_EQ(harness.dispatcher().stats().early, 1U);
  EXPECT_EQ(harness.dispatcher().stats().borders, 1U);
}

TEST(Borders, UpdatesNameTheBordersThatAreStillMissing) {
  BorderHarness harness({{}, {}, {{0, 0}, {1, 0}, {0, 1}}},
                        {{10, 1, 1, 0}, {20, 0, 0, 1}, {30, 0, 0, 0}, {40, 0, 0}, {40, 1, 1}, {50, 0, 2}});
  harness.run();
  const std::vector<Heard> expected = {{1, 0, 0, 0},      {2, 1, 1, 0},      {3, 0, 2, 0b111},
                                       {12, 0, 2, 0b101}, {22, 0, 2, 0b001}, {32, 0, 2, 0}};
  EXPECT_EQ(harness.heard, expected);
}

TEST(Borders, AnotherBorderOfTheSameTileCausesNoUpdate) {
  BorderHarness harness({{}, {{0, 1}}}, {{10, 0, 0, 0}, {20, 0, 0, 1}, {30, 0, 0}, {40, 1, 1}});
  harness.run();
  EXPECT_EQ(harness.heard.size(), 3U);
  EXPECT_EQ(harness.heard.back(), (Heard{22, 1, 1, 0}));
}

TEST(Borders, OfAFinishedTileAreAllPresentEvenThoseNotWritten) {
  BorderHarness harness({{}, {{0, 5}}, {{0, 6}}}, {{10, 0, 0}, {30, 1, 1}, {30, 0, 2}}, 1);
  harness.run();
  const std::vector<Heard> expected = {{1, 0, 0, 0}, {2, 1, 1, 1}, {12, 0, 2, 0}, {12, 1, 1, 0}};
  EXPECT_EQ(harness.heard, expected) << "the third tile takes the place of the first and lacks nothing";
  EXPECT_EQ(harness.dispatcher().stats().early, 1U);
}

TEST(Borders, AllTilesThatImportABorderGetAnUpdate) {
  BorderHarness harness({{}, {{0, 0}}, {{0, 0}}, {{0, 0}}},
                        {{20, 0, 0, 0}, {30, 0, 0}, {30, 1, 1}, {31, 0, 2}, {31, 1, 3}});
  harness.run();
  std::vector<std::uint32_t> notified;
  for (const Heard& h : harness.heard) {
    if (h.cycle > 10) notified.push_back(h.tile);
    EXPECT_EQ(h.missing, h.cycle < 10 && h.tile != 0 ? 1U : 0U);
  }
  std::ranges::sort(notified);
  EXPECT_EQ(notified, (std::vector<std::uint32_t>{1, 2, 3}));
}

TEST(Borders, ImportsAddNoTimeAndTheOracleAgrees) {
  const std::vector<BorderHarness::Said> script = {{10, 0, 0, 2}, {12, 1, 1, 0}, {20, 0, 0}, {22, 1, 1},
                                                   {50, 0, 2},    {51, 1, 3},    {90, 0, 4}};
  const std::vector<std::vector<traces::Border>> imports = {{}, {{0, 2}}, {{0, 0}, {1, 0}}, {{2, 1}}, {{3, 0}, {1, 0}}};
  BorderHarness fast(imports, script), oracle(imports, script), plain({{}, {}, {}, {}, {}}, script);
  fast.run();
  oracle.run<sim::Skip::kOff>();
  plain.run();
  EXPECT_EQ(fast.heard, oracle.heard);
  EXPECT_EQ(fast.end(), oracle.end());
  EXPECT_EQ(fast.end(), plain.end()) << "no tile waits in the dispatcher";
  for (const auto why : {TileDispatcher::CycleReason::kIdle, TileDispatcher::CycleReason::kDispatching,
                         TileDispatcher::CycleReason::kCoresFull, TileDispatcher::CycleReason::kWaiting}) {
    EXPECT_EQ(fast.dispatcher().activity().spent(why), oracle.dispatcher().activity().spent(why));
    EXPECT_EQ(fast.dispatcher().activity().spent(why), plain.dispatcher().activity().spent(why));
  }
}

}  // namespace
}  // namespace hw
