#include "hw_models/frame/front_end.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/frame/bench.h"

namespace hw {
namespace {

using testing::difference;
using testing::Frame;

FrontEnd::Result take_all(FrontEnd& front_end) {
  while (const traces::TileWork* work = front_end.next()) front_end.give_back(work);
  return front_end.result();
}

TEST(FrontEnd, DeliversEveryTileOnceInOrderHoweverManyThreadsMakeThem) {
  const Frame& frame = testing::cornell_64x32();
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
  const Frame& frame = testing::teapot_64x32();
  FrontEnd recorded(frame.program(), frame.tracer(), 0);
  FrontEnd silent(frame.program(), frame.tracer(), 2, false);
  const FrontEnd::Result with_work = take_all(recorded);
  const FrontEnd::Result without = take_all(silent);
  EXPECT_EQ(with_work.rgb, without.rgb);
  EXPECT_GT(with_work.traversal_steps, 0U);
  EXPECT_EQ(without.traversal_steps, 0U) << "steps are counted from the walks";
}

TEST(FrontEnd, MayBeLeftBeforeTheEnd) {
  const Frame& frame = testing::cornell_64x32();
  for (const std::uint32_t workers : {0U, 1U, 3U}) {
    FrontEnd front_end(frame.program(), frame.tracer(), workers);
    EXPECT_NE(front_end.next(), nullptr);
  }
}

TEST(FrontEnd, WorkThatIsHeldStaysValidWhileOthersComeAndGo) {
  const Frame& frame = testing::cornell_64x32();
  FrontEnd front_end(frame.program(), frame.tracer(), 1);
  const traces::TileWork* held = front_end.next();
  const traces::TileWork copy = *held;
  while (const traces::TileWork* work = front_end.next()) front_end.give_back(work);
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

TEST(FrontEnd, AFailureInAThreadComesOutWhereTheTileIsAskedFor) {
  const Frame& frame = testing::cornell_64x32();
  const FailingTracer tracer;
  for (const std::uint32_t workers : {0U, 1U, 2U}) {
    FrontEnd front_end(frame.program(), tracer, workers);
    EXPECT_THROW(front_end.next(), std::runtime_error) << workers;
  }
}

}  // namespace
}  // namespace hw
