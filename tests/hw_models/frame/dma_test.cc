#include "hw_models/frame/dma.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "sim/engine.h"

namespace hw {
namespace {

/// Test harness for a DMA, between a core that sends jobs and a memory.
class DmaHarness {
 public:
  struct Setup {
    std::uint32_t memory_latency = 20;  ///< cycles from request to line
    std::uint32_t memory_interval = 1;  ///< cycles between two accepted requests
    std::uint32_t depth = 8;
  };

  explicit DmaHarness(const Setup& setup)
      : setup_(setup),
        to_memory_(machine_.link<MemRequest>(setup.depth, 1, dma_id_, memory_id_)),
        from_memory_(machine_.link<MemResponse>(64, setup.memory_latency, memory_id_, dma_id_)),
        dma_(machine_.build<Dma>(dma_id_, Dma::Links{jobs_, dones_, to_memory_, from_memory_}, std::uint16_t{0},
                                 clock_)) {
    machine_.build<Core>(core_id_, *this);
    machine_.build<Memory>(memory_id_, *this);
  }

  DmaHarness& add(std::uint32_t bytes, bool write, Addr base = 0, Area area = Area::kPicture) {
    to_send_.push_back({base, bytes, write, static_cast<std::uint32_t>(to_send_.size()), area});
    return *this;
  }
  /// Returns a job whose pixels take `cycles` cycles per line to encode.
  DmaHarness& add_pixels(std::uint32_t bytes, std::uint32_t encode_cycles) {
    add(bytes, true);
    to_send_.back().encode_cycles = encode_cycles;
    return *this;
  }
  template <sim::Skip kSkip = sim::Skip::kOn>
  DmaHarness& run() {
    end_ = clock_.edge_after(sim::run<kSkip>(*this), 1);
    machine_.finish(end_);
    return *this;
  }

  sim::Machine& machine() { return machine_; }
  bool done() const { return done_at_.size() == to_send_.size(); }

  /// Returns the cycles from the arrival of the first job at the DMA to the arrival of the end of job `i` at the core.
  std::uint64_t cycles(std::size_t i) const { return clock_.cycles(done_at_[i]) - 1; }
  const Dma& dma() const { return dma_; }
  const std::vector<Addr>& lines() const { return lines_; }
  const std::vector<std::uint32_t>& tags() const { return tags_; }
  std::uint64_t spent(Dma::CycleReason why) const { return clock_.cycles(dma_.activity().spent(why)); }
  std::uint64_t end() const { return clock_.cycles(end_); }

 private:
  struct Core {
    explicit Core(DmaHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      if (sent < harness.to_send_.size() && harness.jobs_.can_push(now))
        harness.jobs_.push(now, harness.to_send_[sent++]);
      if (harness.dones_.can_pop(now)) {
        harness.tags_.push_back(harness.dones_.pop(now).tag);
        harness.done_at_.push_back(now);
      }
      return harness.clock_.edge_after(now, 1);
    }
    DmaHarness& harness;
    std::size_t sent = 0;
  };
  struct Memory {
    explicit Memory(DmaHarness& b) : harness(b) {}
    sim::Time tick(sim::Time now) {
      if (now >= free_at && harness.to_memory_.can_pop(now) && harness.from_memory_.can_push(now)) {
        const MemRequest r = harness.to_memory_.pop(now);
        harness.lines_.push_back(r.line);
        if (!r.write) harness.from_memory_.push(now, {r.line, r.source, r.tag});
        free_at = harness.clock_.edge_after(now, harness.setup_.memory_interval);
      }
      return harness.clock_.edge_after(now, 1);
    }
    DmaHarness& harness;
    sim::Time free_at = 0;
  };

  Setup setup_;
  sim::Clock clock_{1'000'000};
  sim::Machine machine_;
  const sim::UnitId core_id_ = machine_.unit({"core", clock_});
  const sim::UnitId dma_id_ = machine_.unit({"dma", clock_});
  const sim::UnitId memory_id_ = machine_.unit({"memory", clock_});
  sim::Link<DmaJob>& jobs_ = machine_.link<DmaJob>(4, 1, core_id_, dma_id_);
  sim::Link<DmaDone>& dones_ = machine_.link<DmaDone>(4, 1, dma_id_, core_id_);
  sim::Link<MemRequest>& to_memory_;
  sim::Link<MemResponse>& from_memory_;
  Dma& dma_;
  std::vector<DmaJob> to_send_;
  std::vector<sim::Time> done_at_;
  std::vector<std::uint32_t> tags_;
  std::vector<Addr> lines_;
  sim::Time end_ = 0;
};

constexpr std::uint32_t kLine = 64;

TEST(Dma, AWriteOfNLinesTakesNCyclesAndTheWireBack) {
  for (const std::uint32_t n : {1U, 2U, 16U, 100U}) {
    EXPECT_EQ(DmaHarness({}).add(n * kLine, true).run().cycles(0), n);
  }
}

TEST(Dma, AReadOfNLinesTakesNCyclesAndMemorysLatency) {
  for (const std::uint32_t latency : {1U, 20U, 150U}) {
    for (const std::uint32_t n : {1U, 2U, 16U}) {
      const std::uint64_t wires = 2;  // to memory, and back to the core
      EXPECT_EQ(DmaHarness({.memory_latency = latency}).add(n * kLine, false).run().cycles(0), n - 1 + latency + wires);
    }
  }
}

TEST(Dma, EncodedPixelsTakeTheirCyclesPerLine) {
  for (const std::uint32_t cycles : {1U, 4U, 5U}) {
    for (const std::uint32_t n : {1U, 2U, 16U}) {
      DmaHarness harness({});
      harness.add_pixels(n * kLine, cycles).run();
      EXPECT_EQ(harness.cycles(0), n * cycles);
      EXPECT_EQ(harness.spent(Dma::CycleReason::kMoving), n);
      EXPECT_EQ(harness.spent(Dma::CycleReason::kEncoding), n * (cycles - 1));
      EXPECT_EQ(harness.dma().stats().pixels_encoded, 16 * n);
    }
  }
  DmaHarness plain({});
  plain.add(4 * kLine, true).run();
  EXPECT_EQ(plain.dma().stats().pixels_encoded, 0U);
}

TEST(Dma, AMemorySlowerThanTheEncoderIsTheLimit) {
  DmaHarness harness({.memory_interval = 9, .depth = 1});
  harness.add_pixels(20 * kLine, 4).run();
  EXPECT_GT(harness.cycles(0), 18U * 9);
  EXPECT_EQ(harness.spent(Dma::CycleReason::kEncoding), 20U * 3) << "beside the wait for the line before";
}

TEST(Dma, ASlowMemoryIsTheLimit) {
  DmaHarness harness({.memory_interval = 5, .depth = 2});
  harness.add(20 * kLine, true).run();
  EXPECT_EQ(harness.cycles(0), 1 + (20 - 2 - 1) * 5 + 1 + 1U)
      << "two of the lines are on the wire when the last leaves";
  EXPECT_EQ(harness.spent(Dma::CycleReason::kMoving), 20U);
}

TEST(Dma, TransfersGoOneAfterTheOtherInOrder) {
  DmaHarness harness({});
  harness.add(10 * kLine, true, 0).add(5 * kLine, false, 6400).add(3 * kLine, true, 12800).run();
  EXPECT_EQ(harness.tags(), (std::vector<std::uint32_t>{0, 1, 2}));
  std::vector<Addr> expected;
  for (Addr i = 0; i < 10; ++i) expected.push_back(i * kLine);
  for (Addr i = 0; i < 5; ++i) expected.push_back(6400 + i * kLine);
  for (Addr i = 0; i < 3; ++i) expected.push_back(12800 + i * kLine);
  EXPECT_EQ(harness.lines(), expected);
  EXPECT_EQ(harness.dma().stats().jobs, 3U);
  EXPECT_EQ(harness.dma().stats().lines_written, 13U);
  EXPECT_EQ(harness.dma().stats().lines_read, 5U);
}

TEST(Dma, PartOfALineCostsAWholeOne) {
  DmaHarness harness({});
  harness.add(65, true).run();
  EXPECT_EQ(harness.dma().stats().lines_written, 2U);
}

TEST(Dma, ABlockThatBeginsWithinALineMovesEveryLineItTouches) {
  DmaHarness harness({});
  harness.add(64, true, 640 + 32).add(8, false, 640 + 60).add(16, false, 640 + 16).run();
  EXPECT_EQ(harness.lines(), (std::vector<Addr>{640, 704, 640, 704, 640}));
}

TEST(Dma, LinesAreCountedByAreaAndDirection) {
  DmaHarness harness({});
  std::uint32_t lines = 1;
  for (std::size_t area = 0; area < kAreas; ++area) {
    for (const bool write : {true, false}) harness.add(lines++ * kLine, write, 0, static_cast<Area>(area));
  }
  harness.run();
  std::uint64_t written = 0, read = 0, expected = 1;
  for (const Dma::Stats::Lines& moved : harness.dma().stats().lines) {
    EXPECT_EQ(moved.written, expected++);
    EXPECT_EQ(moved.read, expected++);
    written += moved.written;
    read += moved.read;
  }
  EXPECT_EQ(harness.dma().stats().lines_written, written);
  EXPECT_EQ(harness.dma().stats().lines_read, read);
}

TEST(Dma, EveryCycleHasAReasonAndTheOracleAgrees) {
  const auto fill = [](DmaHarness& b) -> DmaHarness& {
    return b.add(1000, true).add(300, false).add(64, true).add_pixels(300, 4);
  };
  for (const DmaHarness::Setup& setup :
       {DmaHarness::Setup{}, DmaHarness::Setup{.memory_latency = 3, .memory_interval = 7, .depth = 1}}) {
    DmaHarness fast(setup), oracle(setup);
    fill(fast).run();
    fill(oracle).run<sim::Skip::kOff>();
    std::uint64_t sum = 0;
    for (const Dma::CycleReason why : {Dma::CycleReason::kIdle, Dma::CycleReason::kMoving, Dma::CycleReason::kEncoding,
                                       Dma::CycleReason::kWaiting}) {
      EXPECT_EQ(fast.spent(why), oracle.spent(why));
      sum += fast.spent(why);
    }
    EXPECT_EQ(sum, fast.end());
    EXPECT_EQ(fast.spent(Dma::CycleReason::kMoving), 16U + 5U + 1U + 5U);
  }
}

}  // namespace
}  // namespace hw
