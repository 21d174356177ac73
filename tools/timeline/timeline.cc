#include "tools/timeline/timeline.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"
#include "tools/timeline/trace_packets.h"

namespace tools {
namespace {

using perfetto::TimelineTracks, perfetto::to_nanoseconds, perfetto::TracePackets;

/// Parses `count` comma-separated whole numbers; empty if the text is anything else.
std::vector<std::uint32_t> parse_numbers(std::string_view text, std::size_t count) {
  std::vector<std::uint32_t> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (out.size() < count) {
    std::uint32_t number = 0;
    const auto [next, bad] = std::from_chars(at, end, number);
    if (bad != std::errc{}) return {};
    out.push_back(number);
    at = next;
    if (out.size() == count) break;
    if (at == end || *at++ != ',') return {};
  }
  return at == end ? out : std::vector<std::uint32_t>{};
}

/// Returns the rest of `text` after its prefix `word`; none if `text` does not begin with it.
std::optional<std::string_view> text_after_prefix(std::string_view text, std::string_view word) {
  if (!text.starts_with(word)) return {};
  return text.substr(word.size());
}

bool covers_pixel(const TileFrame& tiles, std::size_t row, std::uint32_t x, std::uint32_t y) {
  const auto at = [&](const char* column) { return tiles.at(column)[row]; };
  return x >= at("x") && x < at("x") + at("width") && y >= at("y") && y < at("y") + at("height");
}

/// Returns the distinct values of a column, ascending.
std::vector<double> distinct_values(const std::vector<double>& column) {
  const std::set<double> values(column.begin(), column.end());
  return {values.begin(), values.end()};
}

std::vector<std::size_t> slowest_rows(const TileFrame& tiles, std::size_t count) {
  const std::vector<double>&begin = tiles.at("dispatched"), &end = tiles.at("finished");
  std::vector<std::size_t> rows(tiles.rows());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::stable_sort(rows, std::ranges::greater{}, [&](std::size_t row) { return end[row] - begin[row]; });
  rows.resize(std::min(rows.size(), count));
  return rows;
}

}  // namespace

TimelineSelection parse_timeline(const std::string& text) {
  using Kind = TimelineSelection::Kind;
  if (text == "all") return {};
  if (const auto count = text_after_prefix(text, "slowest:")) {
    const std::vector<std::uint32_t> n = parse_numbers(*count, 1);
    if (!n.empty() && n[0] > 0) return {Kind::kSlowest, n[0], 0, 0};
  }
  if (const auto position = text_after_prefix(text, "tile:")) {
    if (const auto n = parse_numbers(*position, 2); !n.empty()) return {Kind::kTile, 0, n[0], n[1]};
  }
  if (const auto position = text_after_prefix(text, "pixel:")) {
    if (const auto n = parse_numbers(*position, 2); !n.empty()) return {Kind::kPixel, 0, n[0], n[1]};
  }
  throw sim::InputError(fmt::format(
      "--timeline '{}': allowed: all, slowest:N, tile:X,Y (column and row of a tile) or pixel:X,Y, e.g. slowest:8",
      sim::printable(text)));
}

std::vector<std::size_t> selected_tiles(const TimelineSelection& selection, const TileFrame& tiles) {
  using Kind = TimelineSelection::Kind;
  if (selection.kind == Kind::kAll) {
    std::vector<std::size_t> rows(tiles.rows());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    return rows;
  }
  if (selection.kind == Kind::kSlowest) return slowest_rows(tiles, selection.count);
  std::uint32_t x = selection.x, y = selection.y;
  if (selection.kind == Kind::kTile) {
    const std::vector<double> columns = distinct_values(tiles.at("x")), rows = distinct_values(tiles.at("y"));
    if (x >= columns.size() || y >= rows.size()) {
      throw sim::InputError(fmt::format("--timeline tile:{},{}: there is no such tile; allowed: 0,0 to {},{}", x, y,
                                        columns.size() - 1, rows.size() - 1));
    }
    x = static_cast<std::uint32_t>(columns[x]);
    y = static_cast<std::uint32_t>(rows[y]);
  }
  std::vector<std::size_t> found;
  for (std::size_t row = 0; row < tiles.rows(); ++row) {
    if (covers_pixel(tiles, row, x, y)) found.push_back(row);
  }
  if (found.empty()) throw sim::InputError(fmt::format("--timeline pixel:{},{}: there is no such pixel", x, y));
  return found;
}

namespace {

constexpr std::size_t kMostTimeBins = 2048;
constexpr double kLineBytes = 64;
constexpr double kJoulesPerMillijoule = 1e-3;

/// A frame divided into bins of equal time. Each bin is as long as a whole number of the recorder's bins.
class TimeBins {
 public:
  explicit TimeBins(sim::Time elapsed)
      : bins_(1 + static_cast<std::size_t>(elapsed / TimelineRecorder::kBin / kMostTimeBins)),
        length_(bins_ * TimelineRecorder::kBin),
        elapsed_(elapsed),
        count_(static_cast<std::size_t>((elapsed + length_ - 1) / length_)) {}

  std::size_t bin_count() const { return count_; }
  std::size_t display_bin_of(std::size_t bin) const { return std::min(bin / bins_, count_ - 1); }
  sim::Time bin_begin(std::size_t i) const { return i * length_; }
  double bin_seconds(std::size_t i) const {
    return static_cast<double>(std::min(bin_begin(i + 1), elapsed_) - bin_begin(i)) / sim::kFemtosecondsPerSecond;
  }
  /// Spreads an amount evenly over the time bins in [from, to).
  void spread_amount(std::vector<double>& over, sim::Time from, sim::Time to, double amount) const {
    if (from >= to) return;
    for (auto i = static_cast<std::size_t>(from / length_); i < count_ && bin_begin(i) < to; ++i) {
      const sim::Time part = std::min(to, bin_begin(i + 1)) - std::max(from, bin_begin(i));
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
  CounterWriter(const TimeBins& time_bins, TracePackets& to) : time_bins_(time_bins), to_(to) {}

  /// Writes the values of a counter, one per time bin in which the value changes.
  void write_values(std::uint64_t track, auto&& value) {
    double before = -1;
    for (std::size_t i = 0; i < time_bins_.bin_count(); ++i) {
      const double now = value(i);
      if (now != before) to_.add_counter_value(to_nanoseconds(time_bins_.bin_begin(i)), track, now);
      before = now;
    }
  }

 private:
  const TimeBins& time_bins_;
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
  // Limits the number of values of this counter to that of other counters.
  const std::size_t step = 1 + seen.size() / kMostTimeBins;
  for (std::size_t i = 0; i < seen.size(); i += step)
    to.add_counter_value(to_nanoseconds(seen[i].first), track, seen[i].second);
}

std::vector<double> energy_per_bin(const FrameResult& s, const TileFrame& tiles, const TimeBins& time_bins) {
  std::vector<double> out(time_bins.bin_count());
  const TileColumn& energy = *tiles.find("energy_mj_nominal");
  for (std::size_t i = 0; i < tiles.rows(); ++i) {
    const hw::TileAccount& account = s.tile_accounts[i];
    time_bins.spread_amount(out, account.dispatched, account.finished, energy.values[i] * kJoulesPerMillijoule);
  }
  time_bins.spread_amount(out, 0, s.elapsed, energy.rest * kJoulesPerMillijoule);
  return out;
}

/// Writes counters over the whole frame, one value per bin:
///
/// - `DRAM read`, `DRAM write` in GB/s; `L2 hits` in % of lookups; `power` in W of nominal energy
/// - per core `SRP busy` in % of the time, and `rays in T&I` whenever a batch begins or ends
///
/// A tile's energy is spread evenly over its time in flight, the rest evenly over the frame.
void write_counters(const TimelineRecorder& recorder, const FrameResult& s, const TileFrame& tiles,
                    const RunConfig& config, TimelineTracks& tracks, TracePackets& to) {
  const TimeBins time_bins(s.elapsed);
  CounterWriter counters(time_bins, to);
  std::vector<MemoryBin> memory(time_bins.bin_count());
  for (std::size_t bin = 0; bin < recorder.memory_bins().size(); ++bin) {
    const MemoryBin& from = recorder.memory_bins()[bin];
    MemoryBin& sum = memory[time_bins.display_bin_of(bin)];
    sum.l2_hits += from.l2_hits;
    sum.l2_misses += from.l2_misses;
    sum.lines_read += from.lines_read;
    sum.lines_written += from.lines_written;
  }
  const auto rate = [&](std::uint64_t MemoryBin::*lines) {
    return [&, lines](std::size_t i) {
      return static_cast<double>(memory[i].*lines) * kLineBytes / time_bins.bin_seconds(i) / 1e9;
    };
  };
  counters.write_values(tracks.add_shared_counter("DRAM read", "GB/s"), rate(&MemoryBin::lines_read));
  counters.write_values(tracks.add_shared_counter("DRAM write", "GB/s"), rate(&MemoryBin::lines_written));
  counters.write_values(tracks.add_shared_counter("L2 hits", "%"), [&](std::size_t i) {
    const std::uint64_t all = memory[i].l2_hits + memory[i].l2_misses;
    return all == 0 ? 0 : 100 * static_cast<double>(memory[i].l2_hits) / static_cast<double>(all);
  });
  const std::vector<double> spent = energy_per_bin(s, tiles, time_bins);
  counters.write_values(tracks.add_shared_counter("power", "W"),
                        [&](std::size_t i) { return spent[i] / time_bins.bin_seconds(i); });
  for (std::uint32_t core = 0; core < config.gpu->cores; ++core) {
    std::vector<double> busy(time_bins.bin_count());
    for (const RecordedSlice& slice : recorder.slices()) {
      if (slice.kind != RecordedSlice::Kind::kLoop || slice.core != core) continue;
      const auto seconds = static_cast<double>(slice.end - slice.begin) / sim::kFemtosecondsPerSecond;
      time_bins.spread_amount(busy, slice.begin, slice.end, seconds);
    }
    counters.write_values(tracks.add_core_counter(core, "SRP busy", "%"),
                          [&](std::size_t i) { return 100 * busy[i] / time_bins.bin_seconds(i); });
    write_rays(recorder, core, tracks.add_core_counter(core, "rays in T&I", "rays"), to);
  }
}

using Slice = RecordedSlice;
constexpr std::uint32_t kNotSelected = std::numeric_limits<std::uint32_t>::max();

/// Returns a rank for each timeline slice: the position in the selection of the first selected tile during which the
/// slice occurs, or kNotSelected. Slices of the tree builder have rank 0.
std::vector<std::uint32_t> slice_ranks(const std::vector<RecordedSlice>& slices, const std::vector<std::size_t>& rows,
                                       bool all) {
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
    if (slice.kind == Slice::Kind::kBuild) {
      out.push_back(0);
      continue;
    }
    const auto shows = [&](const Window& w) {
      return w.core == slice.core && slice.begin < w.end && slice.end > w.begin;
    };
    const auto first = std::ranges::find_if(windows, shows);
    out.push_back(first == windows.end() ? kNotSelected : static_cast<std::uint32_t>(first - windows.begin()));
  }
  return out;
}

/// Writes the begin and end of timeline slices, with their arguments, as packets of a Perfetto trace.
class SliceWriter {
 public:
  SliceWriter(const FrameResult& s, const TileFrame& tiles) : s_(s), tiles_(tiles) {}

  /// Calls add(time, write) for each event of a timeline slice in order of time; write(packets) adds the event to the
  /// trace.
  void for_each_event(const Slice& slice, std::uint64_t track, auto&& add) const {
    const auto ends = [=](TracePackets& to, std::uint64_t time) { to.end_slice(time, track); };
    add(slice.begin, [=, this](TracePackets& to, std::uint64_t time) { write_begin(slice, track, to, time); });
    if (slice.kind == Slice::Kind::kLoop) {
      const std::array<std::tuple<const char*, sim::Time, sim::Time>, 2> parts = {
          {{"switch", slice.begin, slice.configured}, {"banks", slice.configured, slice.start}}};
      for (const auto& [part, begin, end] : parts) {
        if (to_nanoseconds(begin) == to_nanoseconds(end)) continue;
        add(begin, [=, name = part](TracePackets& to, std::uint64_t time) {
          to.begin_slice(time, track, name, "kernel", 0, {});
        });
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
        to.begin_slice(time, track, fmt::format("tile {}", tile), "tile", flow, {{"tile", tile}, {"steps", steps}});
        break;
      }
      case Slice::Kind::kLoop:
        to.begin_slice(time, track, s_.kernels[slice.kernel].kernel, "kernel", 0,
                       {{"cycles", slice.cycles},
                        {"items", slice.amount},
                        {"launches", slice.launches},
                        {"stalled_ns", to_nanoseconds(slice.stalled)},
                        {"tile", tile}});
        break;
      case Slice::Kind::kRays: {
        constexpr std::array kNames = {"primary rays", "shadow rays", "reflection rays", "refraction rays"};
        to.begin_slice(time, track, kNames.at(slice.what), "rays", flow, {{"rays", slice.amount}, {"tile", tile}});
        break;
      }
      case Slice::Kind::kTransfer: {
        constexpr std::array kAreas = {"picture", "samples", "rates", "build", "tree", "spill"};
        to.begin_slice(time, track, fmt::format("{} {}", slice.to_memory ? "write" : "read", kAreas.at(slice.what)),
                       "transfer", flow, {{"bytes", slice.amount}, {"tile", tile}});
        break;
      }
      case Slice::Kind::kBuild:
        to.begin_slice(time, track, names_of(hw::BuildPass{}).at(slice.what), "build", 0,
                       {{"items", slice.amount}, {"runs", slice.runs}});
        break;
    }
  }

  const FrameResult& s_;
  const TileFrame& tiles_;
};

/// Returns the indices of the selected timeline slices, by rank of their tile and by time; the first ones have priority
/// for space in the file.
std::vector<std::size_t> order_by_rank(const std::vector<RecordedSlice>& slices,
                                       const std::vector<std::uint32_t>& rank) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    if (rank[i] != kNotSelected) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return std::pair(rank[i], slices[i].begin); });
  return order;
}

}  // namespace

Timeline make_timeline(const TimelineRecorder& recorder, const TimelineSelection& selection, const FrameResult& s,
                       const TileFrame& tiles, const RunConfig& config, std::uint64_t most_bytes) {
  const std::vector<RecordedSlice>& slices = recorder.slices();
  const bool all = selection.kind == TimelineSelection::Kind::kAll;
  std::vector<std::size_t> shown = order_by_rank(slices, slice_ranks(slices, selected_tiles(selection, tiles), all));
  const std::size_t wanted = shown.size();

  TimelineTracks tracks(config.gpu->cores);
  TracePackets counters;
  write_counters(recorder, s, tiles, config, tracks, counters);
  // Space for texts, for tracks of ray batches not known yet, and for the part of the last slice beyond the limit.
  constexpr std::uint64_t kSetAside = std::uint64_t{1} << 20;
  const SliceWriter writer(s, tiles);
  TracePackets scratch;
  std::uint64_t used = counters.bytes().size() + std::min(kSetAside, most_bytes / 4);
  std::size_t fitting = 0;
  for (; fitting < shown.size(); ++fitting) {
    const std::size_t before = scratch.bytes().size();
    writer.for_each_event(slices[shown[fitting]], TimelineTracks::kLongestId,
                          [&](sim::Time at, auto&& write) { write(scratch, to_nanoseconds(at)); });
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
    const std::uint64_t track = tracks.track_of(slices[i]);
    std::uint32_t number = 0;
    writer.for_each_event(slices[i], track, [&](sim::Time at, auto&&) {
      events.push_back({to_nanoseconds(at), i, track, number++});
    });
  }
  std::ranges::stable_sort(events, {}, &Event::time);
  TracePackets packets;
  for (const Event& event : events) {
    std::uint32_t number = 0;
    writer.for_each_event(slices[event.slice], event.track, [&](sim::Time at, auto&& write) {
      if (number++ == event.number) write(packets, to_nanoseconds(at));
    });
  }
  TracePackets head;
  tracks.write_descriptors(head);
  return {TracePackets::interned_strings_packet(packets) + head.bytes() + counters.bytes() + packets.bytes(),
          shown.size(), wanted - shown.size()};
}

TimelineJob::TimelineJob(std::string text) : asked_(std::move(text)) {
  if (!asked_.empty()) selection_ = parse_timeline(asked_);
}

void TimelineJob::check_selection(const Inputs& inputs, const kernels::ProgramSpec& program) const {
  if (!selection_ || !selection_->needs_tile_positions()) return;
  const bool is_tile = selection_->kind == TimelineSelection::Kind::kTile;
  kernels::TileGridSize counts{inputs.config.render.width, inputs.config.render.height};
  if (is_tile) counts = tile_grid_size(inputs, program);
  if (selection_->x < counts.columns && selection_->y < counts.rows) return;
  const char* const what = is_tile ? "tile" : "pixel";
  throw sim::InputError(fmt::format(
      "--timeline {}: there is no such {}: the picture's {}s are {} across and {} down; allowed: 0,0 to {},{}", asked_,
      what, what, counts.columns, counts.rows, counts.columns - 1, counts.rows - 1));
}

hw::Observer* TimelineJob::begin_frame(const RunConfig& config) {
  if (!selection_ || made_) return nullptr;
  recorder_.emplace(config.gpu->cores);
  return &*recorder_;
}

void TimelineJob::end_frame(const FrameResult& s, const TileFrame& tiles, const RunConfig& config) {
  if (!recorder_) return;
  try {
    made_ = make_timeline(*recorder_, *selection_, s, tiles, config);
  } catch (const sim::InputError& error) {
    problem_ = error.what();
    selection_.reset();
  }
  recorder_.reset();
}

void TimelineJob::write_file(const std::filesystem::path& folder, sim::Json& report) const {
  if (!problem_.empty()) report["warnings"].push_back(problem_ + "; no timeline is written");
  if (!made_) return;
  sim::write_file_atomically(folder / kTimelineFile, made_->bytes);
  report["timeline"] = {{"asked", asked_}, {"slices", made_->slices}, {"dropped", made_->dropped}};
  if (made_->dropped == 0) return;
  report["warnings"].push_back(fmt::format(
      "{}: {} of {} slices are left out, as it may have {} MiB; --timeline slowest:N or tile:X,Y asks for fewer",
      kTimelineFile, made_->dropped, made_->slices + made_->dropped, kMostTimelineBytes >> 20));
}

void TimelineRecorder::on_event(const hw::Event& event) {
  hw::handle_event(event,
                   hw::HandleEvents{
                       [&](const hw::TileStarted& e) { start_tile(e); },
                       [&](const hw::TileEnded& e) { end_tile(e); },
                       [&](const hw::LoopEnded& e) { add_loop(e); },
                       [&](const hw::BatchStarted& e) {
                         batches_[e.core].push_back({e.slot, e.node, static_cast<std::uint32_t>(e.rays), e.at});
                       },
                       [&](const hw::BatchEnded& e) { end_batch(e); },
                       [&](const hw::TransferEnded& e) { add_transfer(e); },
                       [&](const hw::BuildPassEnded& e) { add_build_pass(e); },
                       [&](const hw::L2LookedUp& e) { (e.hit ? bin_at(e.at).l2_hits : bin_at(e.at).l2_misses) += 1; },
                       [&](const hw::DramServed& e) {
                         (e.request.write ? bin_at(e.end).lines_written : bin_at(e.end).lines_read) += 1;
                       },
                   });
}

/// Returns the entry of the tile list that a tag belongs to. A tag is the index of the entry modulo 2^15. It is looked
/// up among the tiles in flight on the core, because their tags differ.
std::uint32_t TimelineRecorder::entry_of(std::uint32_t core, hw::TileTag tile) const {
  const auto slot = std::ranges::find(slots_[core], tile, &Slot::owner);
  return slot == slots_[core].end() ? RecordedSlice::kNoEntry : slot->entry;
}

void TimelineRecorder::start_tile(const hw::TileStarted& event) {
  std::vector<Slot>& slots = slots_[event.core];
  if (slots.size() <= event.slot) slots.resize(event.slot + 1);
  slots[event.slot] = {event.tile, hw::tile_number_of_tag(event.tile, newest_), event.at};
  newest_ = std::max(newest_, slots[event.slot].entry);
}

void TimelineRecorder::end_tile(const hw::TileEnded& event) {
  Slot& tile = slots_[event.core][event.slot];
  slices_.push_back({.kind = RecordedSlice::Kind::kTile,
                     .core = static_cast<std::uint16_t>(event.core),
                     .slot = static_cast<std::uint16_t>(event.slot),
                     .entry = tile.entry,
                     .begin = tile.begin,
                     .end = event.at});
  tile = {};
}

void TimelineRecorder::add_loop(const hw::LoopEnded& loop) {
  slices_.push_back({.kind = RecordedSlice::Kind::kLoop,
                     .core = static_cast<std::uint16_t>(loop.core),
                     .kernel = loop.kernel,
                     .entry = entry_of(loop.core, loop.tile),
                     .amount = loop.items,
                     .launches = loop.launches,
                     .begin = loop.begin,
                     .end = loop.end,
                     .configured = loop.configured,
                     .start = loop.start,
                     .cycles = loop.cycles,
                     .stalled = loop.stalled});
}

void TimelineRecorder::end_batch(const hw::BatchEnded& event) {
  std::vector<Batch>& batches = batches_[event.core];
  const auto begun =
      std::ranges::find_if(batches, [&](const Batch& b) { return b.slot == event.slot && b.node == event.node; });
  slices_.push_back({.kind = RecordedSlice::Kind::kRays,
                     .what = static_cast<std::uint8_t>(event.batch->ray_kind),
                     .core = static_cast<std::uint16_t>(event.core),
                     .entry = slots_[event.core][event.slot].entry,
                     .amount = event.batch->items,
                     .rays_at_begin = begun->rays,
                     .rays_at_end = static_cast<std::uint32_t>(event.rays),
                     .begin = begun->begin,
                     .end = event.at});
  batches.erase(begun);
}

void TimelineRecorder::add_transfer(const hw::TransferEnded& transfer) {
  slices_.push_back({.kind = RecordedSlice::Kind::kTransfer,
                     .what = static_cast<std::uint8_t>(transfer.area),
                     .to_memory = transfer.to_memory,
                     .core = static_cast<std::uint16_t>(transfer.core),
                     .entry = entry_of(transfer.core, transfer.tile),
                     .amount = transfer.bytes,
                     .begin = transfer.begin,
                     .end = transfer.end});
}

void TimelineRecorder::add_build_pass(const hw::BuildPassEnded& pass) {
  slices_.push_back({.kind = RecordedSlice::Kind::kBuild,
                     .what = static_cast<std::uint8_t>(pass.pass),
                     .amount = pass.items,
                     .runs = pass.runs,
                     .begin = pass.begin,
                     .end = pass.end});
}

}  // namespace tools
