#include "tools/run/frame/front_end.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/hw_models/machines/gpu_harness.h"

namespace tools {
namespace {

using hw::test::difference;
using hw::test::Frame;

RenderResult take_all(FrontEnd& front_end) {
  while (const traces::TileWork* work = front_end.next()) front_end.release_work(work);
  return front_end.result();
}

TEST(FrontEnd, DeliversEveryTileOnceInOrderHoweverManyThreadsMakeThem) {
  const Frame& frame = hw::test::cornell_64x32();
  for (const std::uint32_t workers : {0U, 1U, 2U, 5U}) {
    FrontEnd front_end(frame.program(), frame.tracer(), workers);
    std::vector<const traces::TileWork*> held;
    while (const traces::TileWork* work = front_end.next()) {
      EXPECT_EQ(work->tile, held.size());
      held.push_back(work);
    }
    EXPECT_EQ(held.size(), frame.program().tiles());
    EXPECT_EQ(front_end.next(), nullptr) << "and again nothing";
  }
}

TEST(FrontEnd, APictureWithoutRecordingIsTheSamePicture) {
  const Frame& frame = hw::test::teapot_64x32();
  FrontEnd recorded(frame.program(), frame.tracer(), 0);
  FrontEnd silent(frame.program(), frame.tracer(), 2, false);
  const RenderResult with_work = take_all(recorded);
  const RenderResult without = take_all(silent);
  EXPECT_EQ(with_work.rgb, without.rgb);
  EXPECT_GT(with_work.traversal_steps, 0U);
  EXPECT_EQ(without.traversal_steps, 0U) << "steps are counted from the walks";
}

TEST(FrontEnd, MayBeLeftBeforeTheEnd) {
  const Frame& frame = hw::test::cornell_64x32();
  for (const std::uint32_t workers : {0U, 1U, 3U}) {
    FrontEnd front_end(frame.program(), frame.tracer(), workers);
    EXPECT_NE(front_end.next(), nullptr);
  }
}

TEST(FrontEnd, WorkThatIsHeldStaysValidWhileOthersComeAndGo) {
  const Frame& frame = hw::test::cornell_64x32();
  FrontEnd front_end(frame.program(), frame.tracer(), 1);
  const traces::TileWork* held = front_end.next();
  const traces::TileWork copy = *held;
  while (const traces::TileWork* work = front_end.next()) front_end.release_work(work);
  EXPECT_EQ(held->tile, copy.tile);
  EXPECT_EQ(held->walk, copy.walk);
  EXPECT_EQ(held->sources, copy.sources);
}

class FailingTracer final : public traces::Tracer {
 public:
  void trace(std::span<const traces::Ray>, traces::RayKind, std::span<traces::Hit>, traces::WalkSink*) const override {
    throw std::runtime_error("no tree");
  }
};

TEST(FrontEnd, AFailureInAThreadIsThrownByNext) {
  const Frame& frame = hw::test::cornell_64x32();
  const FailingTracer tracer;
  for (const std::uint32_t workers : {0U, 1U, 2U}) {
    FrontEnd front_end(frame.program(), tracer, workers);
    EXPECT_THROW(front_end.next(), std::runtime_error) << workers;
  }
}

/// A frame program whose tiles a test defines.
class MadeUp final : public kernels::FrameProgram {
 public:
  using Run = std::function<void(std::uint32_t tile_index, kernels::TileResult& out)>;
  MadeUp(std::uint32_t tiles, Run run, std::function<void()> keep = {})
      : FrameProgram(0, 0), tiles_(tiles), run_(std::move(run)), keep_(std::move(keep)) {}
  std::uint32_t tiles() const override { return tiles_; }
  kernels::FrameRequirements requirements() const override { return {}; }
  void run_tile(std::uint32_t tile_index, const traces::Tracer&, bool, kernels::TileResult& out) const override {
    run_(tile_index, out);
  }
  void commit_tile(const kernels::TileResult&) override {
    if (keep_) keep_();
  }

 private:
  const std::uint32_t tiles_;
  const Run run_;
  const std::function<void()> keep_;
};

TEST(FrontEnd, TheFirstOfSeveralFailedTilesIsReportedForAnyNumberOfThreads) {
  const FailingTracer tracer;
  std::mutex mutex;
  std::condition_variable news;
  bool later_has_failed = false;
  MadeUp program(8, [&](std::uint32_t tile_index, kernels::TileResult&) {
    if (tile_index < 2) return;
    std::unique_lock lock(mutex);
    // The thread with the earlier tile finishes later.
    if (tile_index == 2) news.wait_for(lock, std::chrono::milliseconds(500), [&] { return later_has_failed; });
    later_has_failed = tile_index > 2;
    news.notify_all();
    throw std::runtime_error("tile " + std::to_string(tile_index));
  });
  for (const std::uint32_t workers : {0U, 1U, 2U, 5U}) {
    FrontEnd front_end(program, tracer, workers);
    for (int good = 0; good < 2; ++good) EXPECT_NE(front_end.next(), nullptr);
    try {
      front_end.next();
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "tile 2") << workers;
    }
  }
}

TEST(FrontEnd, DoesNotRunAheadByMuchMemory) {
  constexpr std::uint32_t kWorkers = 3, kTiles = 16;
  const FailingTracer tracer;
  std::atomic<std::uint32_t> made = 0;
  MadeUp program(kTiles, [&](std::uint32_t, kernels::TileResult& out) {
    out.work.walk.resize(16U << 20);  // 64 MiB
    made += 1;
  });
  FrontEnd front_end(program, tracer, kWorkers);
  for (std::uint32_t taken = 1; const traces::TileWork* work = front_end.next(); ++taken) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_LT(made, taken + 4 + kWorkers) << "256 MiB, and what is being made when these are full";
    front_end.release_work(work);
  }
  EXPECT_EQ(made, kTiles);
}

#ifndef RAYWATT_SANITIZED  // they end the process instead
TEST(FrontEnd, AFailedAllocationInAThreadIsThrownByNext) {
  const FailingTracer tracer;
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  const auto allow_no_more = [&] {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlimit tight{pages * static_cast<rlim_t>(::getpagesize()) + (8U << 20), before.rlim_max};
    setrlimit(RLIMIT_AS, &tight);
  };
  // All slots reserve memory for the longest tile so far.
  MadeUp program(
      100,
      [](std::uint32_t tile_index, kernels::TileResult& out) { out.work.walk.resize(tile_index == 0 ? 16U << 20 : 0); },
      allow_no_more);
  for (const std::uint32_t workers : {1U, 2U}) {
    bool refused = false;
    {
      FrontEnd front_end(program, tracer, workers);
      try {
        take_all(front_end);
      } catch (const std::bad_alloc&) {
        refused = true;
      }
    }
    setrlimit(RLIMIT_AS, &before);
    EXPECT_TRUE(refused) << workers;
  }
}
#endif

}  // namespace
}  // namespace tools
