#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/srp/messages.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// A core's DMA engine moves blocks between the core's tile buffer and memory, bypassing the L2, one line per cycle.
///
///   jobs --> [one at a time, in order] --> line requests --> memory
///
/// 1. The DMA may sRGB-encode finished pixels with a table, instead of kernel pack_colour. A line then takes as many
/// cycles as reading its linear colours from the tile buffer.
/// 2. A job that writes is done when its last line has been sent, a job that reads when its last line has arrived.
/// 3. A partial line costs as much as a whole line.
///
/// Not modelled: the read of the old line before a partial write.
class Dma {
 public:
  static constexpr const char* kName = "core.dma";
  static constexpr Block kBlock = Block::kDma;
  enum class CycleReason : std::uint8_t { kIdle, kMoving, kEncoding, kWaiting, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "no transfer")},
      {CycleReason::kMoving, sim::working_reason("moving", "a request was sent")},
      {CycleReason::kEncoding, sim::working_reason("encoding", "a line's pixels are sRGB-encoded")},
      {CycleReason::kWaiting, sim::waiting_reason("waiting", "lines are in flight, or a request waits for room")},
  });
  struct Stats {
    struct Lines {
      std::uint64_t written = 0, read = 0;
    };
    std::uint64_t jobs = 0, lines_written = 0, lines_read = 0, pixels_encoded = 0;
    std::array<Lines, kAreas> lines{};  ///< lines moved by the DMA, by Area of memory
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.jobs), "transfers finished");
      counter(NAMED(s.lines_written), "lines written to memory", "dma.line");
      counter(NAMED(s.lines_read), "lines read from memory", "dma.line");
      counter(NAMED(s.pixels_encoded), "pixels sRGB-encoded on their way to memory", "dma.srgb_encode");
      // Lines for building trees have no counters: they are the rest of all lines.
      [[maybe_unused]] auto& [picture, samples, rates, build, tree, spill] = s.lines;
      counter(picture.written, "picture_lines_written", "of these, finished pixels");
      counter(picture.read, "picture_lines_read", "of these, finished pixels");
      counter(samples.written, "samples_lines_written", "of these, attributes and colours of samples");
      counter(samples.read, "samples_lines_read", "of these, attributes and colours of samples");
      counter(rates.written, "rates_lines_written", "of these, sampling rates of tiles");
      counter(rates.read, "rates_lines_read", "of these, sampling rates of tiles");
      counter(spill.written, "spill_lines_written", "of these, ray slots that did not fit");
      counter(spill.read, "spill_lines_read", "of these, ray slots that did not fit");
    }
  };
  struct Links {
    sim::Link<DmaJob>& jobs_in;
    sim::Link<DmaDone>& done_out;
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
    Observer* observer = nullptr;
    std::uint32_t core = 0;  ///< number of the core that owns the DMA, reported in events
  };

  Dma(Links links, std::uint16_t client, sim::Clock clock) : clock_(clock), links_(links), client_(client) {}
  Dma(const Dma&) = delete;
  Dma& operator=(const Dma&) = delete;

  sim::Time tick(sim::Time now);
  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  std::uint64_t retired_items() const { return stats_.lines_written + stats_.lines_read; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  void finish(sim::Time end) { activity_.finish(end); }
  std::string state() const;

 private:
  bool move_line(sim::Time now);
  sim::Time next_wake(sim::Time now) const;
  bool is_encoding(sim::Time now) const { return active_ && lines_left_ > 0 && now < encoded_at_; }

  const sim::Clock clock_;
  Links links_;
  const std::uint16_t client_;
  bool active_ = false;
  DmaJob job_;
  Addr next_line_ = 0;
  std::uint32_t lines_left_ = 0;  ///< lines of the current DMA job not requested yet
  std::uint32_t replies_left_ = 0;
  sim::Time begun_at_ = 0;    ///< start time of the current DMA job
  sim::Time encoded_at_ = 0;  ///< time at which sRGB encoding of the next line ends
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
