#include "tools/timeline/timeline.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "tools/timeline/counters.h"
#include "tools/timeline/trace_packets.h"
#include "tools/timeline/tracks.h"

namespace tools {
namespace {

using Slice = RecordedSlice;
constexpr std::uint32_t kNotWanted = std::numeric_limits<std::uint32_t>::max();

/// Returns for each slice the rank, among the selected tiles, of the tile for which it is shown, or kNotWanted.
std::vector<std::uint32_t> ranks(const std::vector<Slice>& slices, const std::vector<std::size_t>& rows, bool all) {
  if (all) return std::vector<std::uint32_t>(slices.size(), 0);
  struct Window {
    std::uint16_t core = 0;
    sim::Time begin = 0, end = 0;
  };
  std::vector<Window> windows(rows.size());
  for (const Slice& slice : slices) {
    if (slice.kind != Slice::Kind::kTile) continue;
    const auto row = std::ranges::find(rows, slice.entry);
    if (row != rows.end()) windows[static_cast<std::size_t>(row - rows.begin())] = {slice.core, slice.begin, slice.end};
  }
  std::vector<std::uint32_t> out;
  out.reserve(slices.size());
  for (const Slice& slice : slices) {
    const auto shows = [&](const Window& w) {
      return w.core == slice.core && slice.begin < w.end && slice.end > w.begin;
    };
    const auto first = std::ranges::find_if(windows, shows);
    out.push_back(first == windows.end() ? kNotWanted : static_cast<std::uint32_t>(first - windows.begin()));
  }
  return out;
}

/// Writes slices as packets.
class SliceWriter {
 public:
  SliceWriter(const FrameResult& s, const TileFrame& tiles) : s_(s), tiles_(tiles) {}

  /// Calls add(time, write) for each event of a slice in order; write(packets) adds it.
  void each_event(const Slice& slice, std::uint64_t track, auto&& add) const {
    const auto ends = [=](TracePackets& to, std::uint64_t time) { to.end(time, track); };
    add(slice.begin, [=, this](TracePackets& to, std::uint64_t time) { write_begin(slice, track, to, time); });
    if (slice.kind == Slice::Kind::kLoop) {
      const std::array<std::tuple<const char*, sim::Time, sim::Time>, 2> parts = {
          {{"switch", slice.begin, slice.configured}, {"banks", slice.configured, slice.start}}};
      for (const auto& [part, begin, end] : parts) {
        if (nanoseconds(begin) == nanoseconds(end)) continue;
        add(begin,
            [=, name = part](TracePackets& to, std::uint64_t time) { to.begin(time, track, name, "kernel", 0, {}); });
        add(end, ends);
      }
    }
    add(slice.end, ends);
  }

 private:
  void write_begin(const Slice& slice, std::uint64_t track, TracePackets& to, std::uint64_t time) const {
    const bool has_tile = slice.entry != Slice::kNoEntry;
    const std::uint64_t tile = has_tile ? static_cast<std::uint64_t>(tiles_.at("tile")[slice.entry]) : 0;
    const std::uint64_t flow = has_tile ? slice.entry + 1 : 0;
    switch (slice.kind) {
      case Slice::Kind::kTile: {
        const auto steps = static_cast<std::uint64_t>(tiles_.at("steps")[slice.entry]);
        to.begin(time, track, fmt::format("tile {}", tile), "tile", flow, {{"tile", tile}, {"steps", steps}});
        break;
      }
      case Slice::Kind::kLoop:
        to.begin(time, track, s_.kernels[slice.kernel].kernel, "kernel", 0,
                 {{"cycles", slice.cycles},
                  {"items", slice.amount},
                  {"launches", slice.launches},
                  {"stalled_ns", nanoseconds(slice.stalled)},
                  {"tile", tile}});
        break;
      case Slice::Kind::kRays: {
        constexpr std::array kNames = {"primary rays", "shadow rays", "reflection rays", "refraction rays"};
        to.begin(time, track, kNames.at(slice.what), "rays", flow, {{"rays", slice.amount}, {"tile", tile}});
        break;
      }
      case Slice::Kind::kTransfer: {
        constexpr std::array kAreas = {"picture", "samples", "rates", "spill"};
        to.begin(time, track, fmt::format("{} {}", slice.to_memory ? "write" : "read", kAreas.at(slice.what)),
                 "transfer", flow, {{"bytes", slice.amount}, {"tile", tile}});
        break;
      }
    }
  }

  const FrameResult& s_;
  const TileFrame& tiles_;
};

/// Returns the slices in order of rank, in which they get room.
std::vector<std::size_t> in_order_of_rank(const std::vector<Slice>& slices, const std::vector<std::uint32_t>& rank) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    if (rank[i] != kNotWanted) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return std::pair(rank[i], slices[i].begin); });
  return order;
}

}  // namespace

Timeline make_timeline(const TimelineRecorder& recorder, const TimelineSelection& selection, const FrameResult& s,
                       const TileFrame& tiles, const RunConfig& config, std::uint64_t most_bytes) {
  const std::vector<Slice>& slices = recorder.slices();
  const bool all = selection.kind == TimelineSelection::Kind::kAll;
  std::vector<std::size_t> shown = in_order_of_rank(slices, ranks(slices, selected_tiles(selection, tiles), all));
  const std::size_t wanted = shown.size();

  TimelineTracks tracks(config.gpu->cores);
  TracePackets counters;
  write_counters(recorder, s, tiles, config, tracks, counters);
  // Room for texts, for tracks of lanes not yet known, and for the part of the last slice beyond the limit.
  constexpr std::uint64_t kSetAside = std::uint64_t{1} << 20;
  const SliceWriter writer(s, tiles);
  TracePackets scratch;
  std::uint64_t used = counters.bytes().size() + std::min(kSetAside, most_bytes / 4);
  std::size_t fitting = 0;
  for (; fitting < shown.size(); ++fitting) {
    const std::size_t before = scratch.bytes().size();
    writer.each_event(slices[shown[fitting]], TimelineTracks::kLongestId,
                      [&](sim::Time at, auto&& write) { write(scratch, nanoseconds(at)); });
    used += scratch.bytes().size() - before;
    if (used > most_bytes) break;
  }
  shown.resize(fitting);
  std::ranges::stable_sort(shown, {}, [&](std::size_t i) { return slices[i].begin; });

  struct Event {
    std::uint64_t time = 0;
    std::size_t slice = 0;
    std::uint64_t track = 0;
    std::uint32_t number = 0;  ///< index among the slice's events
  };
  std::vector<Event> events;
  for (const std::size_t i : shown) {
    const std::uint64_t track = tracks.of(slices[i]);
    std::uint32_t number = 0;
    writer.each_event(slices[i], track, [&](sim::Time at, auto&&) {
      events.push_back({nanoseconds(at), i, track, number++});
    });
  }
  std::ranges::stable_sort(events, {}, &Event::time);
  TracePackets packets;
  for (const Event& event : events) {
    std::uint32_t number = 0;
    writer.each_event(slices[event.slice], event.track, [&](sim::Time at, auto&& write) {
      if (number++ == event.number) write(packets, nanoseconds(at));
    });
  }
  TracePackets head;
  tracks.describe(head);
  return {TracePackets::texts_of(packets) + head.bytes() + counters.bytes() + packets.bytes(), shown.size(),
          wanted - shown.size()};
}

}  // namespace tools
