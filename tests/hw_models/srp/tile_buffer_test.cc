#include "hw_models/srp/tile_buffer.h"

#include <gtest/gtest.h>

namespace hw {
namespace {

constexpr sim::Clock kClock{1'000'000};

TEST(TileBuffer, RaySlotsFillTheRoomAfterTheColoursOfTilesInFlight) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), (65536U - 3 * 256 * 16) / 64);
  config.tiles_in_flight = 1;
  config.colour_bytes = 12;
  config.slot_bytes = 96;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), (65536U - 256 * 12) / 96);
}

TEST(TileBuffer, SmallerThanTheColoursItHasNoSlots) {
  TileBufferConfig config;
  config.size.bytes = 12 * 1024;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), 0U);
  config.size.bytes = 1024;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), 0U);
}

TEST(TileBuffer, AttributesOfTheTilesInFlightLeaveFewerRaySlots) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  const std::uint64_t without = TileBuffer(config, {.tile_samples = 256}, kClock).slot_count();
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256, .attribute_bytes = 64 * 25}, kClock).slot_count(),
            without - 3 * 25);
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256, .attribute_bytes = 256 * 1024}, kClock).slot_count(), 0U);
}

TEST(TilesInFlight, RaySlotsKeepTheirShareAtTheCostOfTiles) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  const traces::FrameRequirements light{.tile_samples = 256}, heavy{.tile_samples = 256, .attribute_bytes = 12 * 1024};
  EXPECT_EQ(tiles_in_flight(config, heavy, false).first, 3U);
  config.ray_share = 0.5;
  EXPECT_EQ(tiles_in_flight(config, light, false).first, 3U);
  EXPECT_EQ(tiles_in_flight(config, heavy, false).first, 2U);
  EXPECT_EQ(TileBuffer(config, heavy, kClock).slot_count(), 32U * 1024 / 64);
  EXPECT_EQ(tiles_in_flight(config, heavy, true).first, 3U) << "an ideal buffer has room for all";
  config.ray_share = 0.9;
  EXPECT_EQ(tiles_in_flight(config, heavy, false).first, 1U) << "one there always is";
}

TEST(TilesInFlight, TilesOfLaterPassesShareTheRoomOfThoseOfTheFirst) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  config.tiles_in_pass = 16;
  traces::FrameRequirements needs{.tile_samples = 256, .attribute_bytes = 4 * 1024};
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 3U) << "they keep as much";
  needs.pass_attribute_bytes = 1024;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 3U * 8 / 5);
  config.colour_bytes = 4;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 3U * 5 / 2) << "smaller accumulators leave room for more";
  config.tiles_in_pass = 5;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 5U);
  needs.pass_attribute_bytes = 64 * 1024;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 1U);
}

TEST(TileBuffer, SlotsTakenAreNotFreeUntilReturned) {
  TileBufferConfig config;
  config.size.bytes = 3 * 256 * 16 + 64 * 100;
  TileBuffer buffer(config, {.tile_samples = 256}, kClock);
  EXPECT_EQ(buffer.allocate_slots(60), 0U);
  EXPECT_EQ(buffer.free_slots(), 40U);
  EXPECT_EQ(buffer.allocate_slots(40), 0U);
  EXPECT_EQ(buffer.free_slots(), 0U);
  buffer.free_ray_slots(70);
  EXPECT_EQ(buffer.free_slots(), 70U);
  EXPECT_EQ(buffer.used_slots(), 30U);
  EXPECT_EQ(buffer.stats().slots_taken, 100U);
  EXPECT_EQ(buffer.stats().slots_peak, 100U);
  EXPECT_EQ(buffer.stats().spilled_slots, 0U);
}

TEST(TileBuffer, OnlySlotsThatDoNotFitAreSpilled) {
  TileBufferConfig config;
  config.size.bytes = 3 * 256 * 16 + 64 * 100;
  TileBuffer buffer(config, {.tile_samples = 256}, kClock);
  EXPECT_EQ(buffer.allocate_slots(130), 30U);
  EXPECT_EQ(buffer.allocate_slots(10), 10U) << "nothing is free any more";
  buffer.free_ray_slots(60);
  EXPECT_EQ(buffer.free_slots(), 20U) << "140 were taken, 80 are still in use";
  EXPECT_EQ(buffer.stats().spilled_slots, 40U);
}

TEST(TileBuffer, IsIdleOrInUseInEveryCycle) {
  TileBuffer buffer({}, {.tile_samples = 256}, kClock);
  buffer.set_in_use(10 * kClock.period(), true);
  buffer.set_in_use(50 * kClock.period(), false);
  buffer.set_in_use(70 * kClock.period(), true);
  buffer.finish(100 * kClock.period());
  EXPECT_EQ(kClock.cycles(buffer.activity().spent(TileBuffer::CycleReason::kInUse)), 40U + 30U);
  EXPECT_EQ(kClock.cycles(buffer.activity().spent(TileBuffer::CycleReason::kIdle)), 10U + 20U);
}

}  // namespace
}  // namespace hw
