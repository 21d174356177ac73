#include <gtest/gtest.h>

#include "tests/hw_models/machines/conservation.h"
#include "tests/hw_models/machines/gpu_harness.h"

// Tests of machines without the direct interface, where rays and hits go through memory, and with an ideal L2 or
// interconnect.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
using test::play;

GpuConfig through_memory(L2Writes writes) {
  GpuConfig c;
  c.direct_interface.enabled = false;
  c.l2.writes = writes;
  return c;
}

TEST(DirectInterface, OffChangesTimeAndTrafficAndNothingElse) {
  const Frame& frame = test::cornell_64x32();
  const Outcome on = play(frame, GpuConfig{});
  for (const L2Writes writes : {L2Writes::kBack, L2Writes::kThrough, L2Writes::kAround}) {
    const GpuConfig config = through_memory(writes);
    const Outcome run = play(frame, config);
    expect_conserved(run, frame, config);
    EXPECT_EQ(difference(on.function, run.function), "");
    EXPECT_GT(run.sum("channel", "bytes"), on.sum("channel", "bytes") + 96 * run.rays());
    EXPECT_EQ(run.sum("bank", "bytes_written"), 96 * run.rays()) << "64 bytes of ray and 32 of hit";
  }
}

TEST(DirectInterface, OffAgreesWithTheOracleForEveryWritePolicy) {
  static const Frame frame("cornell", 32, 16);
  for (const L2Writes writes : {L2Writes::kBack, L2Writes::kThrough, L2Writes::kAround}) {
    GpuConfig config = through_memory(writes);
    config.l2.cache.size.bytes = 8 * 1024;
    config.interconnect.arbitration = Arbitration::kOldestFirst;
    const Outcome fast = play(frame, config);
    expect_conserved(fast, frame, config);
    EXPECT_EQ(difference(fast, play(frame, config, Engine::kOracle)), "");
    EXPECT_EQ(difference(fast, play(frame, config, Engine::kShuffled, 5)), "");
  }
}

TEST(DirectInterface, OffFinishesWithQueuesOfOneAndARingOfOne) {
  static const Frame frame("cornell", 16, 16);
  for (const L2Writes writes : {L2Writes::kBack, L2Writes::kThrough, L2Writes::kAround}) {
    for (const Arbitration arbitration : {Arbitration::kRoundRobin, Arbitration::kOldestFirst, Arbitration::kFixed}) {
      GpuConfig c = through_memory(writes);
      c.direct_interface.depth = c.direct_interface.ring = 1;
      c.direct_interface.ray_bytes = 72;
      c.interconnect.arbitration = arbitration;
      c.interconnect.link_depth = 1;
      c.l2.banks = c.l2.cache.mshrs = c.l2.targets = c.l2.cache.ways = 1;
      c.l2.cache.size.bytes = 64;
      c.dram.channels = 1;
      c.dram.controller.read_queue = c.dram.controller.write_queue = c.dram.controller.write_high = 1;
      c.dram.controller.write_low = 0;
      expect_conserved(play(frame, c), frame, c);
    }
  }
}

TEST(DirectInterface, ASmallRingStaysInTheL2) {
  const Frame& frame = test::cornell_64x32();
  GpuConfig config = through_memory(L2Writes::kBack);
  const std::uint64_t large = play(frame, config).sum("bank", "bytes_to_memory");
  config.direct_interface.ring = 128;
  const Outcome run = play(frame, config);
  EXPECT_LT(run.sum("bank", "bytes_to_memory"), large / 2);
  EXPECT_GT(run.sum("bank", "bytes_overwritten"), 48 * run.rays());
}

TEST(IdealMachine, AnIdealL2OrInterconnectNeverCostsTime) {
  const Frame& frame = test::teapot_64x32();
  for (const bool direct : {true, false}) {
    GpuConfig config;
    config.direct_interface.enabled = direct;
    config.l2.cache.size.bytes = 16 * 1024;
    const Outcome real = play(frame, config);
    GpuConfig l2 = config, net = config;
    l2.ideal.l2 = net.ideal.interconnect = true;
    const Outcome of_l2 = play(frame, l2), of_net = play(frame, net);
    expect_conserved(of_l2, frame, l2);
    expect_conserved(of_net, frame, net);
    EXPECT_EQ(of_l2.sum("bank", "fills"), 0U);
    EXPECT_LT(of_l2.cycles, real.cycles);
    EXPECT_LT(of_net.cycles, real.cycles);
    EXPECT_EQ(difference(of_l2, play(frame, l2, Engine::kOracle)), "");
    EXPECT_EQ(difference(of_net, play(frame, net, Engine::kOracle)), "");
  }
}

}  // namespace
}  // namespace hw
