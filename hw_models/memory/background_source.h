#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "hw_models/memory/messages.h"
#include "hw_models/memory/unit_names.h"
#include "sim/config/field.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/time.h"
#include "sim/unit_report.h"

namespace hw {

/// Order of the addresses of a background stream.
enum class BackgroundPattern : std::uint8_t {
  kSequential,  ///< consecutive lines, as read by a display or a camera
  kRandom,      ///< random lines, as read by cache misses of processor cores
};
constexpr std::array<std::string_view, 2> names_of(BackgroundPattern) { return {"sequential", "random"}; }

/// Configuration of the memory traffic that the rest of the chip causes while the GPU renders.
struct BackgroundConfig {
  double rate = 0;
  BackgroundPattern pattern = BackgroundPattern::kSequential;
  double writes = 0.25;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.rate), "GB/s",
          "bandwidth of the rest of the chip's reads and writes, summed over all channels; 0: none",
          sim::between(0, 1000), Affects::kTiming);
    field(NAMED(c.pattern), "", "order of the traffic's addresses", sim::any(), Affects::kTiming);
    field(NAMED(c.writes), "", "fraction of the lines that are written", sim::between(0, 1), Affects::kTiming);
  }
};

/// Sends one DRAM channel its share of the chip's background traffic, line by line at a steady rate.
///
///   [next line, when it is due] --> channel --> [data of reads are dropped]
///
/// 1. Line k is due at time k / rate. If the channel does not accept a line, it waits, and later lines catch up.
/// 2. The addresses are in the upper half of the channel, which the GPU does not use.
/// 3. The source stops when it receives a Flush at the end of the frame.
/// 4. The lines cost DRAM energy like all others.
/// 5. The traffic bypasses the system cache, because it represents the misses of that cache.
///
/// Not modelled: traffic bursts, clients that wait for their reads.
class BackgroundSource {
 public:
  static constexpr const char* kName = "background.source";
  static constexpr Block kBlock = Block::kOutside;
  enum class CycleReason : std::uint8_t { kStopped, kSending, kPaced, kBlocked, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kStopped, sim::idle_reason("stopped", "the frame is over")},
      {CycleReason::kSending, sim::working_reason("sending", "a request was sent")},
      {CycleReason::kPaced, sim::background_reason("paced", "the next line is not due yet")},
      {CycleReason::kBlocked, sim::waiting_reason("blocked", "a line is due and the channel has no room")},
  });
  struct Stats {
    std::uint64_t reads = 0, writes = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.reads), "lines read for the rest of the chip");
      counter(NAMED(s.writes), "lines written for the rest of the chip");
    }
  };
  struct Links {
    sim::Link<MemRequest>& memory_out;
    sim::Link<MemResponse>& memory_in;
    sim::Link<Flush>& flush_in;
  };
  /// Address mapping of one DRAM channel: which lines of memory are in the channel.
  struct ChannelMapping {
    std::uint32_t channel = 0, channels = 1;
    std::uint64_t line_bytes = kLineBytes;
    std::uint64_t granule = kLineBytes;  ///< number of consecutive bytes that are mapped to one channel
    std::uint64_t lines = 1 << 20;       ///< capacity of the channel in lines
  };

  BackgroundSource(const BackgroundConfig& config, const ChannelMapping& place, Links links, sim::Clock clock);
  BackgroundSource(const BackgroundSource&) = delete;
  BackgroundSource& operator=(const BackgroundSource&) = delete;

  sim::Time tick(sim::Time now);
  void finish(sim::Time end) { activity_.finish(end); }
  /// True if the background source has received its Flush and no read is outstanding.
  bool idle() const { return stopped_ && outstanding_ == 0; }

  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  std::string state() const;

 private:
  sim::Time next_due_time() const;
  MemRequest next_request() const;

  const BackgroundConfig config_;
  const ChannelMapping place_;
  const Links links_;
  const sim::Clock clock_;
  const double interval_;  ///< time between two lines of background traffic, in femtoseconds
  std::uint64_t sent_ = 0;
  std::uint64_t outstanding_ = 0;
  bool stopped_ = false;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
