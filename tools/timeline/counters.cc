#include "tools/timeline/counters.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "hw_models/machines/gpu_config.h"

namespace tools {
namespace {

constexpr std::size_t kMostStretches = 2048;
constexpr double kLineBytes = 64;
constexpr double kJoulesPerMillijoule = 1e-3;

/// A frame divided into bins of equal time, each a whole number of the recorder's bins.
class Stretches {
 public:
  explicit Stretches(sim::Time elapsed)
      : bins_(1 + static_cast<std::size_t>(elapsed / TimelineRecorder::kBin / kMostStretches)),
        length_(bins_ * TimelineRecorder::kBin),
        elapsed_(elapsed),
        count_(static_cast<std::size_t>((elapsed + length_ - 1) / length_)) {}

  std::size_t count() const { return count_; }
  std::size_t of_bin(std::size_t bin) const { return std::min(bin / bins_, count_ - 1); }
  sim::Time begin(std::size_t i) const { return i * length_; }
  double seconds(std::size_t i) const {
    return static_cast<double>(std::min(begin(i + 1), elapsed_) - begin(i)) / sim::kFemtosecondsPerSecond;
  }
  /// Spreads an amount evenly over [from, to).
  void spread(std::vector<double>& over, sim::Time from, sim::Time to, double amount) const {
    if (from >= to) return;
    for (auto i = static_cast<std::size_t>(from / length_); i < count_ && begin(i) < to; ++i) {
      const sim::Time part = std::min(to, begin(i + 1)) - std::max(from, begin(i));
      over[i] += amount * static_cast<double>(part) / static_cast<double>(to - from);
    }
  }

 private:
  std::size_t bins_;
  sim::Time length_, elapsed_;
  std::size_t count_;
};

class CounterWriter {
 public:
  CounterWriter(const Stretches& stretches, TracePackets& to) : stretches_(stretches), to_(to) {}

  /// Writes a value per bin, only where it changes.
  void write(std::uint64_t track, auto&& value) {
    double before = -1;
    for (std::size_t i = 0; i < stretches_.count(); ++i) {
      const double now = value(i);
      if (now != before) to_.count(nanoseconds(stretches_.begin(i)), track, now);
      before = now;
    }
  }

 private:
  const Stretches& stretches_;
  TracePackets& to_;
};

void write_rays(const TimelineRecorder& recorder, std::uint32_t core, std::uint64_t track, TracePackets& to) {
  std::vector<std::pair<sim::Time, std::uint32_t>> seen;
  for (const RecordedSlice& slice : recorder.slices()) {
    if (slice.kind != RecordedSlice::Kind::kRays || slice.core != core) continue;
    seen.emplace_back(slice.begin, slice.rays_at_begin);
    seen.emplace_back(slice.end, slice.rays_at_end);
  }
  std::ranges::stable_sort(seen, {}, &std::pair<sim::Time, std::uint32_t>::first);
  // At most as many values as other counters.
  const std::size_t step = 1 + seen.size() / kMostStretches;
  for (std::size_t i = 0; i < seen.size(); i += step) to.count(nanoseconds(seen[i].first), track, seen[i].second);
}

std::vector<double> joules(const FrameResult& s, const TileFrame& tiles, const Stretches& stretches) {
  std::vector<double> out(stretches.count());
  const TileColumn& energy = *tiles.find("energy_mj_nominal");
  for (std::size_t i = 0; i < tiles.rows(); ++i) {
    const hw::TileAccount& account = s.tile_accounts[i];
    stretches.spread(out, account.dispatched, account.finished, energy.values[i] * kJoulesPerMillijoule);
  }
  stretches.spread(out, 0, s.elapsed, energy.rest * kJoulesPerMillijoule);
  return out;
}

}  // namespace

void write_counters(const TimelineRecorder& recorder, const FrameResult& s, const TileFrame& tiles,
                    const RunConfig& config, TimelineTracks& tracks, TracePackets& to) {
  const Stretches stretches(s.elapsed);
  CounterWriter counters(stretches, to);
  std::vector<MemoryBin> memory(stretches.count());
  for (std::size_t bin = 0; bin < recorder.memory().size(); ++bin) {
    const MemoryBin& from = recorder.memory()[bin];
    MemoryBin& sum = memory[stretches.of_bin(bin)];
    sum.l2_hits += from.l2_hits;
    sum.l2_misses += from.l2_misses;
    sum.lines_read += from.lines_read;
    sum.lines_written += from.lines_written;
  }
  const auto rate = [&](std::uint64_t MemoryBin::*lines) {
    return [&, lines](std::size_t i) {
      return static_cast<double>(memory[i].*lines) * kLineBytes / stretches.seconds(i) / 1e9;
    };
  };
  counters.write(tracks.shared_counter("DRAM read", "GB/s"), rate(&MemoryBin::lines_read));
  counters.write(tracks.shared_counter("DRAM write", "GB/s"), rate(&MemoryBin::lines_written));
  counters.write(tracks.shared_counter("L2 hits", "%"), [&](std::size_t i) {
    const std::uint64_t all = memory[i].l2_hits + memory[i].l2_misses;
    return all == 0 ? 0 : 100 * static_cast<double>(memory[i].l2_hits) / static_cast<double>(all);
  });
  const std::vector<double> spent = joules(s, tiles, stretches);
  counters.write(tracks.shared_counter("power", "W"), [&](std::size_t i) { return spent[i] / stretches.seconds(i); });
  for (std::uint32_t core = 0; core < config.gpu->cores; ++core) {
    std::vector<double> busy(stretches.count());
    for (const RecordedSlice& slice : recorder.slices()) {
      if (slice.kind != RecordedSlice::Kind::kLoop || slice.core != core) continue;
      const auto seconds = static_cast<double>(slice.end - slice.begin) / sim::kFemtosecondsPerSecond;
      stretches.spread(busy, slice.begin, slice.end, seconds);
    }
    counters.write(tracks.core_counter(core, "SRP busy", "%"),
                   [&](std::size_t i) { return 100 * busy[i] / stretches.seconds(i); });
    write_rays(recorder, core, tracks.core_counter(core, "rays in T&I", "rays"), to);
  }
}

}  // namespace tools
