#include <algorithm>

#include <gtest/gtest.h>

#include "hw_models/machines/memory_system.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/memory/harness.h"

namespace hw::test {
namespace {

GpuConfig machine(std::uint32_t cores) {
  GpuConfig config;
  config.cores = cores;
  return config;
}

/// Test harness for the whole memory system: cores with cache clients and a DMA client, L2 banks, DRAM channels.
struct MemorySide {
  static constexpr std::size_t kClients = 3;

  explicit MemorySide(const GpuConfig& c)
      : config(c), harness(c.clocks.synchroniser), memory(harness.machine(), config, MemorySystem::Dma::kYes) {
    for (std::uint32_t core = 0; core < config.cores; ++core) {
      memory.declare_ports();
      for (std::size_t i = 0; i <= kClients; ++i) {
        const sim::UnitId unit = harness.machine().unit({"requester", kClock, core + 1});
        const MemoryPort port = i == kClients ? memory.add_dma_client(core, unit)
                                              : memory.add_cache_client(core, {unit, config.interconnect.link_depth});
        harness.add_requester(unit, port.requests, port.responses, port.client);
      }
      memory.build_ports(core);
    }
    memory.build_banks_and_channels();
  }

  Requester& client(std::size_t core, std::size_t i) { return *harness.requesters[core * (kClients + 1) + i]; }
  Requester& dma(std::size_t core) { return client(core, kClients); }

  const GpuConfig config;
  Harness harness;
  MemorySystem memory;
};

void random_traffic(MemorySide& m, std::uint64_t requests, std::uint64_t lines, std::size_t cores) {
  for (std::uint64_t i = 0; i < requests; ++i) {
    const std::size_t core = i % cores;
    const Addr line = sim::hash(i, 3) % lines * 64;
    const std::uint64_t pause = i * 4 / requests * 3000;
    if (i % 5 == 0) {
      m.dma(core).send(line, pause, sim::hash(i, 4) % 2 == 0);
    } else {
      m.client(core, sim::hash(i, 5) % MemorySide::kClients).send(line, pause);
    }
  }
}

TEST(MemorySide, AnUncontendedL2MissCosts80To150Nanoseconds) {
  MemorySide m(machine(1));
  m.client(0, 0).send(64 * 5);
  m.client(0, 0).send(64 * 5, 1000);
  m.harness.run();
  const std::uint64_t miss = m.client(0, 0).script[0].latency() * 2;
  const std::uint64_t hit = m.client(0, 0).script[1].latency() * 2;
  RecordProperty("miss_ns", static_cast<int>(miss));
  EXPECT_GE(miss - hit, 80U);
  EXPECT_LE(miss, 150U);
  EXPECT_EQ(hit, 2 * (1 + 4 + 12 + 4 + 1U)) << "client's wire, up, bank, down, client's wire";
}

TEST(MemorySide, EveryRequestIsAnsweredAndCountedOnceAtEachLevel) {
  MemorySide m(machine(2));
  random_traffic(m, 8000, 20000, 2);
  m.harness.run();
  std::uint64_t requests = 0, lookups = 0, fills = 0, l2_misses = 0, bytes = 0, dma = 0;
  for (const Requester* r : m.harness.requesters) {
    EXPECT_TRUE(r->done());
    EXPECT_EQ(r->mistakes, 0);
  }
  for (const CorePort* p : m.memory.core_ports()) requests += p->stats().requests;
  for (const L2Bank* b : m.memory.l2_banks()) {
    lookups += b->stats().reads;
    fills += b->stats().fills;
    l2_misses += b->stats().misses - b->stats().merges;
  }
  for (const DramChannel* c : m.memory.dram_channels()) bytes += c->stats().bytes;
  for (std::size_t core : {0U, 1U}) dma += m.dma(core).script.size();
  EXPECT_EQ(requests, 8000U);
  EXPECT_EQ(lookups + dma, 8000U);
  EXPECT_EQ(fills, l2_misses);
  EXPECT_EQ(bytes, 64 * (fills + dma));
}

TEST(MemorySide, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const std::uint32_t depth : {1U, 4U}) {
    for (const std::uint32_t cores : {1U, 3U}) {
      std::string expected;
      for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
        GpuConfig config = machine(cores);
        config.l2.cache.size = {32 * 1024};
        config.dram.channels = cores == 1 ? 4 : 2;
        config.interconnect.link_depth = depth;
        MemorySide m(config);
        random_traffic(m, 3000, cores == 1 ? 1000 : 50000, cores);
        m.client(0, 1).pop_every = 9;
        const sim::Time end = m.harness.run(mode);
        const std::string all = m.harness.everything(end);
        if (mode == Mode::kSkip) expected = all;
        ASSERT_EQ(all, expected) << "depth " << depth << ", cores " << cores;
        for (const sim::UnitReport& r : m.harness.reports()) {
          const std::uint64_t period = r.block == "dram" ? config.dram.timing.ck.time : kClock.period();
          EXPECT_EQ(r.elapsed, end / period + 1) << r.path;
        }
      }
    }
  }
}

// Tests of the system cache in front of the DRAM channels, and of other traffic of the chip on these channels.

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
using test::play;

GpuConfig with_cache(std::uint64_t bytes) {
  GpuConfig c;
  c.l2.cache.size = {16 * 1024};
  c.slc.cache.size = {bytes};
  return c;
}

GpuConfig with_traffic(double rate, BackgroundPattern pattern = BackgroundPattern::kSequential) {
  GpuConfig c;
  c.background.rate = rate;
  c.background.pattern = pattern;
  return c;
}

double microseconds(const Outcome& run) { return static_cast<double>(run.elapsed) * 1e-9; }

TEST(SystemCache, AnswersTheL2AndTheDmaAndReadsTheRestFromTheChannels) {
  const Outcome run = play(test::teapot_64x32(), with_cache(64 * 1024));
  EXPECT_EQ(run.sum("slice", "reads"), run.sum("bank", "fills") + run.sum("dma", "lines_read"));
  EXPECT_EQ(run.sum("slice", "writes"),
            run.sum("dma", "lines_written") + run.sum("bank", "written_back") + run.sum("bank", "passed_on"));
  EXPECT_EQ(run.sum("slice", "hits") + run.sum("slice", "misses"), run.sum("slice", "reads"));
  EXPECT_EQ(run.sum("slice", "fills") + run.sum("slice", "merges"), run.sum("slice", "misses"));
  EXPECT_EQ(run.sum("channel", "reads"), run.sum("slice", "fills"));
  EXPECT_EQ(run.sum("channel", "writes"), run.sum("slice", "written_back"));
  EXPECT_GT(run.sum("slice", "hits"), 0U);
}

TEST(SystemCache, SavesMoreReadsOfMemoryIfItIsLarger) {
  const Outcome none = play(test::teapot_64x32(), with_cache(0));
  std::uint64_t before = none.sum("channel", "reads");
  EXPECT_ANY_THROW(none.sum("slice", "reads")) << "there are no slices";
  for (const std::uint64_t kib : {64U, 256U, 4096U}) {
    const Outcome run = play(test::teapot_64x32(), with_cache(kib * 1024));
    EXPECT_LT(run.sum("channel", "reads"), before) << kib << " KiB";
    EXPECT_EQ(difference(run.function, none.function), "") << "the picture";
    before = run.sum("channel", "reads");
  }
}

TEST(SystemCache, OfNoSizeHasNoEffect) {
  const GpuConfig plain;
  GpuConfig shaped;
  shaped.slc.cache.ways = 4;
  shaped.slc.lookup_cycles = 60;
  EXPECT_EQ(difference(play(test::cornell_64x32(), plain), play(test::cornell_64x32(), shaped)), "");
}

TEST(SystemCache, OfAShapeThatDoesNotFitTheChannelsIsRefused) {
  GpuConfig c = with_cache(1 << 20);
  c.slc.cache.mshrs = 2;
  EXPECT_THROW(sim::check_config(c), sim::InputError);
  c = with_cache(3000);
  EXPECT_THROW(sim::check_config(c), sim::InputError);
  EXPECT_NO_THROW(sim::check_config(with_cache(1 << 20)));
}

TEST(Background, SendsItsRateWhileTheFrameRuns) {
  for (const BackgroundPattern pattern : {BackgroundPattern::kSequential, BackgroundPattern::kRandom}) {
    const GpuConfig config = with_traffic(4, pattern);
    const Outcome run = play(test::cornell_64x32(), config);
    const double lines = static_cast<double>(run.sum("source", "reads") + run.sum("source", "writes"));
    EXPECT_NEAR(lines, 4e3 * microseconds(run) / 64, 0.01 * lines + 4);
    EXPECT_NEAR(static_cast<double>(run.sum("source", "writes")) / lines, config.background.writes, 0.03);
    EXPECT_EQ(run.sum("channel", "reads"),
              run.sum("source", "reads") + run.sum("bank", "fills") + run.sum("dma", "lines_read"));
  }
}

TEST(Background, SlowsTheFrameMoreAtAHigherRateAndChangesNoPicture) {
  const Outcome alone = play(test::teapot_64x32(), GpuConfig{});
  std::uint64_t before = alone.cycles;
  for (const double rate : {8.0, 20.0}) {
    const Outcome run = play(test::teapot_64x32(), with_traffic(rate, BackgroundPattern::kRandom));
    EXPECT_GT(run.cycles, before) << rate;
    EXPECT_EQ(difference(run.function, alone.function), "");
    before = run.cycles;
  }
}

TEST(Background, OfMoreThanTheMemoryCanMoveStillLetsTheFrameEnd) {
  const Outcome run = play(test::cornell_64x32(), with_traffic(1000));
  EXPECT_GT(run.sum("source", "reads"), 0U);
  const double moved = static_cast<double>(run.sum("channel", "bytes")) / microseconds(run) / 1e3;
  EXPECT_LT(moved, 25.7) << "GB/s, the peak of four channels";
}

TEST(Background, TakesOneOfTheRequestersOfAChannel) {
  GpuConfig c;
  c.l2.banks = 32;
  c.l2.cache.mshrs = 32;
  c.cores = 32;
  EXPECT_NO_THROW(sim::check_config(c));
  c.background.rate = 1;
  EXPECT_THROW(sim::check_config(c), sim::InputError);
}

TEST(SystemCacheAndBackground, AreTheSameInEveryEngine) {
  static const Frame frame("cornell", 16, 16);
  for (const std::uint64_t kib : {0U, 16U, 1024U}) {
    for (const double rate : {0.0, 3.0, 40.0}) {
      GpuConfig config = with_cache(kib * 1024);
      config.background.rate = rate;
      config.background.pattern = kib == 16 ? BackgroundPattern::kRandom : BackgroundPattern::kSequential;
      config.direct_interface.enabled = kib != 16;  // rays then go through memory, which causes writes
      const Outcome fast = play(frame, config);
      EXPECT_EQ(difference(fast, play(frame, config, Engine::kOracle)), "") << kib << " KiB, " << rate << " GB/s";
      for (const std::uint64_t seed : {1U, 2U}) {
        EXPECT_EQ(difference(fast, play(frame, config, Engine::kShuffled, seed)), "") << kib << " " << rate;
      }
    }
  }
}

}  // namespace

}  // namespace hw::test
