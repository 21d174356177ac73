#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/frame/front_end.h"
#include "hw_models/frame/gpu.h"
#include "sim/engine.h"
#include "tests/allocations/count.h"
#include "tests/hw_models/frame/bench.h"

// Once a frame is well under way, nothing is allocated any more: storage is used again.

namespace test {
namespace {

enum Half : std::uint8_t { kTiming, kFunction };

/// A frame whose list has every tile several times, so that its end meets nothing that is larger than before.
class Again final : public kernels::FrameProgram {
 public:
  Again(kernels::FrameProgram& frame, std::uint32_t times)
      : FrameProgram(frame.width(), frame.height()), frame_(frame), times_(times) {}
  std::uint32_t tiles() const override { return times_ * frame_.tiles(); }
  kernels::Demands demands() const override { return frame_.demands(); }
  void run_tile(std::uint32_t place, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override {
    frame_.run_tile(place % frame_.tiles(), tracer, record, out);
  }

 private:
  kernels::FrameProgram& frame_;
  const std::uint32_t times_;
};

/// Counts while the last round is handed out, but for its last tile, which takes the picture; and tells the functional
/// half from the machine.
class Counting final : public hw::TileSource {
 public:
  Counting(hw::FrontEnd& front_end, std::uint32_t warm_up, std::uint32_t end, CountAllocations& count)
      : front_end_(front_end), warm_up_(warm_up), end_(end), count_(count) {}
  const traces::TileWork* next() override {
    if (taken_ == warm_up_) count_.start();
    count_.group(kFunction);
    const traces::TileWork* work = front_end_.next();
    count_.group(kTiming);
    taken_ += 1;
    if (taken_ == warm_up_) rays_before_ = rays();
    if (taken_ == end_) count_.stop();
    return work;
  }
  void give_back(const traces::TileWork* work) override {
    count_.group(kFunction);
    front_end_.give_back(work);
    count_.group(kTiming);
  }
  std::uint64_t rays_counted() const { return rays() - rays_before_; }

 private:
  std::uint64_t rays() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t n : front_end_.result().rays) sum += n;
    return sum;
  }

  hw::FrontEnd& front_end_;
  const std::uint32_t warm_up_, end_;
  CountAllocations& count_;
  std::uint32_t taken_ = 0;
  std::uint64_t rays_before_ = 0;
};

class Allocations : public testing::TestWithParam<const char*> {};

TEST_P(Allocations, StopWhenAFrameIsWellUnderWay) {
  if (!can_count_allocations()) GTEST_SKIP() << "the sanitizer has the heap";
  constexpr std::uint32_t kTimes = 6;
  const hw::testing::Frame frame(GetParam(), 192, 96);
  Again again(frame.program(), kTimes);
  hw::FrontEnd front_end(again, frame.tracer(), 0);
  CountAllocations count;
  Counting tiles(front_end, (kTimes - 1) * frame.program().tiles(), again.tiles() - 1, count);
  hw::Gpu gpu(hw::GpuConfig{}, frame.workload(), tiles);
  sim::run(gpu);
  EXPECT_GT(tiles.rays_counted(), 30'000U);
  EXPECT_EQ(count.count(kFunction), 0U) << "functional half, for " << tiles.rays_counted() << " rays:\n"
                                        << count.sites(kFunction);
  EXPECT_EQ(count.sites(kTiming, {}), "") << "timing half, for " << tiles.rays_counted() << " rays";
}

INSTANTIATE_TEST_SUITE_P(OfScenes, Allocations, testing::Values("cornell", "chess"));

}  // namespace
}  // namespace test
