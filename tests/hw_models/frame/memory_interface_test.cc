#include "hw_models/frame/memory_interface.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/engine.h"
#include "sim/unit_report.h"
#include "tests/hw_models/memory/harness.h"

// Tests of the memory interface with sources and sinks of records, and memories that answer in order.

namespace hw {
namespace {

const sim::Clock kClock(2'000'000);
constexpr std::uint64_t kMemory = 40;  ///< latency of a memory's answer in cycles

/// Sends records with ids 0, 1, 2..., one every `interval` cycles from `begin` on.
template <class Record>
struct Giver {
  Giver(sim::Link<Record>& to, std::uint32_t records) : out(to), count(records) {}
  sim::Time tick(sim::Time now) {
    if (given < count && now >= next && out.can_push(now)) {
      Record record;
      record.id = given++;
      out.push(now, record);
      next = now + interval * kClock.period();
    }
    return given == count ? sim::kNever : std::max({now + kClock.period(), next, out.push_at()});
  }

  sim::Link<Record>& out;
  std::uint32_t count = 0;
  std::uint64_t interval = 1;
  sim::Time next = 0;
  std::uint32_t given = 0;
};

/// Receives a record every `interval` cycles and records the arrival times.
template <class Record>
struct Taker {
  explicit Taker(sim::Link<Record>& from) : in(from) {}
  sim::Time tick(sim::Time now) {
    if (now >= next && in.can_pop(now)) {
      in_order &= in.pop(now).id == taken.size();
      taken.push_back(kClock.cycles(now));
      next = now + interval * kClock.period();
    }
    return in.pop_at() == sim::kNever ? sim::kNever : std::max({now + kClock.period(), next, in.pop_at()});
  }

  sim::Link<Record>& in;
  std::uint64_t interval = 1;
  sim::Time next = 0;
  bool in_order = true;
  std::vector<std::uint64_t> taken{};
};

struct Machine {
  explicit Machine(DirectInterfaceConfig config, std::uint32_t rays, std::uint32_t hits = 0)
      : ray_giver(units.build<Giver<RayJob>>(ray_giver_id, rays_in, rays)),
        hit_giver(units.build<Giver<RayDone>>(hit_giver_id, hits_in, hits)),
        ray_taker(units.build<Taker<RayJob>>(ray_taker_id, rays_out)),
        hit_taker(units.build<Taker<RayDone>>(hit_taker_id, hits_out)),
        unit(units.build<MemoryInterface>(unit_id, config, Addr{4096}, std::uint16_t{0},
                                          MemoryInterface::Rays::Links{rays_in, rays_out, *up[0], *down[0]},
                                          MemoryInterface::Hits::Links{hits_in, hits_out, *up[1], *down[1]}, kClock)) {
    for (std::size_t i : {0U, 1U}) memories[i] = &units.build<test::Echo>(memory_id[i], kClock, *up[i], *down[i]);
  }

  sim::Machine& machine() { return units; }
  bool done() const { return ray_taker.taken.size() == ray_giver.count && hit_taker.taken.size() == hit_giver.count; }

  /// Simulates in one of three engine modes and returns all results as text, which must not depend on the mode.
  std::string run(int engine = 0) {
    const sim::Time end = engine == 0   ? sim::run<sim::Skip::kOn>(*this)
                          : engine == 1 ? sim::run<sim::Skip::kOff>(*this)
                                        : sim::run_shuffled(*this, 3);
    units.finish(end + 1);
    std::string all_of_it = std::to_string(end);
    const sim::UnitReport report = sim::report_of(unit, "unit");
    EXPECT_EQ(report.elapsed, kClock.cycles(end) + 1);
    for (const auto& [why, cycles] : report.cycles_by_reason) all_of_it += " " + why + " " + std::to_string(cycles);
    for (const sim::CounterReport& c : report.counters) all_of_it += " " + c.name + " " + std::to_string(c.value);
    EXPECT_TRUE(ray_taker.in_order);
    EXPECT_TRUE(hit_taker.in_order);
    return all_of_it;
  }
  std::uint64_t why(MemoryInterface::CycleReason w) const { return kClock.cycles(unit.activity().spent(w)); }

  sim::UnitId declare(const char* name) { return units.unit({name, kClock}); }

  sim::Machine units;
  const sim::UnitId ray_giver_id = declare("rays"), hit_giver_id = declare("hits");
  const sim::UnitId ray_taker_id = declare("ray taker"), hit_taker_id = declare("hit taker");
  const sim::UnitId unit_id = declare("unit"), memory_id[2] = {declare("memory0"), declare("memory1")};
  sim::Link<RayJob>& rays_in = units.link<RayJob>(4, 1, ray_giver_id, unit_id);
  sim::Link<RayJob>& rays_out = units.link<RayJob>(4, 1, unit_id, ray_taker_id);
  sim::Link<RayDone>& hits_in = units.link<RayDone>(4, 1, hit_giver_id, unit_id);
  sim::Link<RayDone>& hits_out = units.link<RayDone>(4, 1, unit_id, hit_taker_id);
  sim::Link<MemRequest>* up[2] = {&units.link<MemRequest>(2, 1, unit_id, memory_id[0]),
                                  &units.link<MemRequest>(2, 1, unit_id, memory_id[1])};
  sim::Link<MemResponse>* down[2] = {&units.link<MemResponse>(64, kMemory, memory_id[0], unit_id),
                                     &units.link<MemResponse>(64, kMemory, memory_id[1], unit_id)};
  Giver<RayJob>& ray_giver;
  Giver<RayDone>& hit_giver;
  Taker<RayJob>& ray_taker;
  Taker<RayDone>& hit_taker;
  MemoryInterface& unit;
  test::Echo* memories[2] = {};
};

DirectInterfaceConfig off() {
  DirectInterfaceConfig c;
  c.enabled = false;
  return c;
}

constexpr std::uint64_t kLone = 1 + 1 + 1 + kMemory;  // time in the unit: write, read, link, memory

TEST(MemoryInterface, ASingleRayIsWrittenReadBackAndDelivered) {
  Machine m(off(), 1);
  m.run();
  EXPECT_EQ(m.unit.stats().ray_latency, kLone);
  EXPECT_EQ(m.ray_taker.taken[0], 1 + kLone + 1) << "and a wire at each end";
  EXPECT_EQ(m.unit.stats().ray_writes, 1U);
  EXPECT_EQ(m.unit.stats().ray_reads, 1U);
  EXPECT_EQ(m.memories[0]->written, 64U);
}

TEST(MemoryInterface, ASingleHitDoesNotWaitForAnotherToFillItsLine) {
  Machine m(off(), 0, 1);
  m.run();
  EXPECT_EQ(m.unit.stats().hit_latency, kLone);
  EXPECT_EQ(m.memories[1]->written, 32U);
}

TEST(MemoryInterface, HitsThatArriveTogetherShareALine) {
  Machine m(off(), 0, 400);
  m.run();
  EXPECT_LE(m.unit.stats().hit_writes, 202U) << "the first goes alone, and may the last";
  EXPECT_EQ(m.memories[1]->written, 400U * 32);
}

TEST(MemoryInterface, ALineOfRecordsCostsTwoRequestsAndARequestLeavesEachCycle) {
  for (const std::uint32_t bytes : {16U, 32U, 48U, 64U, 96U, 256U}) {
    DirectInterfaceConfig c = off();
    c.ray_bytes = bytes;
    c.depth = 64;
    Machine m(c, 1200);
    m.run();
    const double cycles = static_cast<double>(m.ray_taker.taken[1100] - m.ray_taker.taken[100]) / 1000;
    EXPECT_NEAR(cycles, std::max(1.0, 2.0 * bytes / 64), 0.02) << bytes;
    EXPECT_EQ(m.memories[0]->written, std::uint64_t{1200} * bytes);
  }
}

TEST(MemoryInterface, ReadsAheadNoFurtherThanItsDepth) {
  for (const std::uint32_t depth : {1U, 4U, 10U}) {
    DirectInterfaceConfig c = off();
    c.depth = depth;
    Machine m(c, 400);
    m.run();
    const double cycles = static_cast<double>(m.ray_taker.taken[300] - m.ray_taker.taken[100]) / 200;
    // Each delivered record allows one more read, which takes its latency and one cycle.
    EXPECT_NEAR(cycles, static_cast<double>(1 + kMemory) / depth, 1.0) << depth;
  }
}

TEST(MemoryInterface, ARingOfOneRecordIsWrittenAgainAndAgain) {
  DirectInterfaceConfig c = off();
  c.ring = c.depth = 1;
  for (const std::uint32_t bytes : {8U, 40U, 200U}) {
    c.ray_bytes = c.hit_bytes = bytes;
    Machine m(c, 50, 50);
    m.run();
    EXPECT_EQ(m.ray_taker.taken.size(), 50U);
    EXPECT_EQ(m.memories[1]->written, std::uint64_t{50} * bytes);
  }
}

TEST(MemoryInterface, ABlockedReaderIsTheReason) {
  Machine m(off(), 200);
  m.ray_taker.interval = 100;
  m.run();
  EXPECT_GT(m.why(MemoryInterface::CycleReason::kOutputFull), 15'000U);
}

TEST(MemoryInterface, RecordsDoNotDependOnTheEngine) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    DirectInterfaceConfig c = off();
    c.ray_bytes = 8 * static_cast<std::uint32_t>(1 + sim::hash(seed, 1) % 32);
    c.hit_bytes = 8 * static_cast<std::uint32_t>(1 + sim::hash(seed, 2) % 32);
    c.ring = static_cast<std::uint32_t>(1 + sim::hash(seed, 3) % 20);
    c.depth = static_cast<std::uint32_t>(1 + sim::hash(seed, 4) % 10);
    std::string expected;
    for (const int engine : {0, 1, 2}) {
      Machine m(c, 300, 250);
      m.ray_giver.interval = 1 + sim::hash(seed, 5) % 50;
      m.hit_taker.interval = 1 + sim::hash(seed, 6) % 50;
      const std::string all = m.run(engine);
      if (engine == 0) expected = all;
      ASSERT_EQ(all, expected) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace hw
