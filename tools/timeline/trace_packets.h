#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <protozero/pbf_writer.hpp>

#include "tools/timeline/timeline.h"

/// Encodes the packets of a Perfetto trace, with its tracks and interned strings.
namespace tools::perfetto {

/// Table of interned strings. Events of a trace refer to a string by its number.
class InternedTexts {
 public:
  std::uint64_t number_of(std::string_view text) {
    return numbers_.try_emplace(std::string(text), numbers_.size() + 1).first->second;
  }
  const std::map<std::string, std::uint64_t>& all_texts() const { return numbers_; }

 private:
  std::map<std::string, std::uint64_t> numbers_;
};

/// A track of the timeline. It shows slices, or a counter if the track has a unit of measurement.
struct TimelineTrack {
  std::uint64_t id = 0, parent = 0;
  std::string name;
  std::int32_t rank = 0;  ///< order among the tracks with the same parent
  std::string unit = {};
};

constexpr std::uint64_t to_nanoseconds(sim::Time time) { return time / sim::kFemtosecondsPerNanosecond; }

// Field numbers of the Perfetto messages that a timeline uses, from its published protos:
// protos/perfetto/trace/trace_packet.proto, track_event/*.proto, interned_data/interned_data.proto.

using Tag = protozero::pbf_tag_type;
using Writer = protozero::pbf_writer;

constexpr Tag kTracePacket = 1;

struct Packet {
  static constexpr Tag kTimestamp = 8, kSequence = 10, kTrackEvent = 11, kInternedData = 12, kSequenceFlags = 13,
                       kTrackDescriptor = 60;
  static constexpr std::uint32_t kStateCleared = 1, kNeedsState = 2;
};
struct Track {
  static constexpr Tag kUuid = 1, kName = 2, kProcess = 3, kParent = 5, kCounter = 8, kChildOrdering = 11, kRank = 12;
  static constexpr std::int32_t kExplicit = 3;
};
struct Process {
  static constexpr Tag kPid = 1, kName = 6;
};
struct Counter {
  static constexpr Tag kUnitName = 6;
};
struct Event {
  static constexpr Tag kCategory = 3, kAnnotation = 4, kType = 9, kName = 10, kTrack = 11, kCounterValue = 44,
                       kFlow = 47;
  static constexpr std::int32_t kBegin = 1, kEnd = 2, kCounter = 4;
};
struct Annotation {
  static constexpr Tag kName = 1, kUint = 3;
};
struct Interned {
  static constexpr Tag kCategories = 1, kNames = 2, kAnnotationNames = 3;
  static constexpr Tag kId = 1, kText = 2;  ///< field numbers of an entry in the tables of texts
};

constexpr std::uint32_t kSequence = 1;

inline void add_texts(Writer& interned, Tag tag, const InternedTexts& texts) {
  for (const auto& [text, number] : texts.all_texts()) {
    Writer entry(interned, tag);
    entry.add_uint64(Interned::kId, number);
    entry.add_string(Interned::kText, text);
  }
}

/// Serialised packets of a Perfetto trace. Times are in nanoseconds, rounded down.
class TracePackets {
 public:
  /// Adds a Perfetto process for a part of the machine. The tracks of this part are children of the process.
  void add_process(std::uint64_t id, std::string_view name, std::int32_t rank) {
    add_packet([&](Writer& packet) {
      Writer track(packet, Packet::kTrackDescriptor);
      track.add_uint64(Track::kUuid, id);
      {
        Writer process(track, Track::kProcess);
        process.add_int32(Process::kPid, static_cast<std::int32_t>(id));
        process.add_string(Process::kName, name.data(), name.size());
      }
      track.add_int32(Track::kChildOrdering, Track::kExplicit);
      track.add_int32(Track::kRank, rank);
    });
  }
  void add_track(const TimelineTrack& of) {
    add_packet([&](Writer& packet) {
      Writer track(packet, Packet::kTrackDescriptor);
      track.add_uint64(Track::kUuid, of.id);
      track.add_string(Track::kName, of.name);
      track.add_uint64(Track::kParent, of.parent);
      if (!of.unit.empty()) {
        Writer counter(track, Track::kCounter);
        counter.add_string(Counter::kUnitName, of.unit);
      }
      track.add_int32(Track::kRank, of.rank);
    });
  }
  /// Begins a slice of the timeline on a track. `flow`: number of the flow that connects it with other slices; 0: none.
  void begin_slice(std::uint64_t time, std::uint64_t track, std::string_view name, std::string_view category,
                   std::uint64_t flow, std::initializer_list<std::pair<std::string_view, std::uint64_t>> notes) {
    add_packet([&](Writer& packet) {
      packet.add_uint64(Packet::kTimestamp, time);
      Writer event(packet, Packet::kTrackEvent);
      event.add_int32(Event::kType, Event::kBegin);
      event.add_uint64(Event::kTrack, track);
      event.add_uint64(Event::kName, names_.number_of(name));
      event.add_uint64(Event::kCategory, categories_.number_of(category));
      if (flow != 0) event.add_fixed64(Event::kFlow, flow);
      for (const auto& [note, value] : notes) {
        Writer annotation(event, Event::kAnnotation);
        annotation.add_uint64(Annotation::kName, notes_.number_of(note));
        annotation.add_uint64(Annotation::kUint, value);
      }
    });
  }
  void end_slice(std::uint64_t time, std::uint64_t track) {
    add_packet([&](Writer& packet) {
      packet.add_uint64(Packet::kTimestamp, time);
      Writer event(packet, Packet::kTrackEvent);
      event.add_int32(Event::kType, Event::kEnd);
      event.add_uint64(Event::kTrack, track);
    });
  }
  void add_counter_value(std::uint64_t time, std::uint64_t track, double value) {
    add_packet([&](Writer& packet) {
      packet.add_uint64(Packet::kTimestamp, time);
      Writer event(packet, Packet::kTrackEvent);
      event.add_int32(Event::kType, Event::kCounter);
      event.add_uint64(Event::kTrack, track);
      event.add_double(Event::kCounterValue, value);
    });
  }

  const std::string& bytes() const { return bytes_; }
  /// Returns the packet with which a trace file must begin. It defines the interned strings to which the packets of
  /// `other` refer.
  static std::string interned_strings_packet(const TracePackets& other) {
    std::string bytes;
    Writer trace(bytes);
    Writer packet(trace, perfetto::kTracePacket);
    {
      Writer interned(packet, Packet::kInternedData);
      add_texts(interned, Interned::kCategories, other.categories_);
      add_texts(interned, Interned::kNames, other.names_);
      add_texts(interned, Interned::kAnnotationNames, other.notes_);
    }
    packet.add_uint32(Packet::kSequence, kSequence);
    packet.add_uint32(Packet::kSequenceFlags, Packet::kStateCleared);
    return bytes;
  }

 private:
  void add_packet(auto&& fill) {
    Writer trace(bytes_);
    Writer packet(trace, perfetto::kTracePacket);
    fill(packet);
    packet.add_uint32(Packet::kSequence, kSequence);
    packet.add_uint32(Packet::kSequenceFlags, Packet::kNeedsState);
  }

  std::string bytes_;
  InternedTexts names_, categories_, notes_;
};

/// Ranks of tracks within a core or within `shared`, top to bottom.
enum Rank : std::int32_t { kOfTiles = 0, kOfBuilder = 0, kOfSrp = 100, kOfRays = 101, kOfDma = 102, kOfCounters = 103 };

/// Tracks of a timeline: a process for each core, and one shared by all.
class TimelineTracks {
 public:
  static constexpr std::uint64_t kLongestId = 0xffffffff;  ///< id with the longest encoding

  explicit TimelineTracks(std::uint32_t cores) : cores_(cores) {}

  /// Returns the track of a timeline slice. Call it for a core's slices in the order in which they begin, because
  /// overlapping batches of rays get different tracks.
  std::uint64_t track_of(const RecordedSlice& slice) {
    if (slice.kind == RecordedSlice::Kind::kBuild) {
      if (builder_ == 0) builder_ = create_track(shared_process(), "tree builder", kOfBuilder);
      return builder_;
    }
    Core& core = cores_[slice.core];
    const std::uint64_t parent = process_of(slice.core);
    switch (slice.kind) {
      case RecordedSlice::Kind::kLoop:
        if (core.srp == 0) core.srp = create_track(parent, "SRP", kOfSrp);
        return core.srp;
      case RecordedSlice::Kind::kTransfer:
        if (core.dma == 0) core.dma = create_track(parent, "DMA", kOfDma);
        return core.dma;
      case RecordedSlice::Kind::kTile: {
        if (core.slots.size() <= slice.slot) core.slots.resize(std::size_t{slice.slot} + 1);
        std::uint64_t& slot = core.slots[slice.slot];
        if (slot == 0) slot = create_track(parent, fmt::format("tile slot {}", slice.slot), kOfTiles + slice.slot);
        return slot;
      }
      case RecordedSlice::Kind::kRays:
      case RecordedSlice::Kind::kBuild:
        break;
    }
    const auto is_free = [&](const Lane& lane) { return lane.free_at <= slice.begin; };
    auto lane = std::ranges::find_if(core.rays, is_free);
    if (lane == core.rays.end()) {
      core.rays.push_back({create_track(parent, "T&I rays", kOfRays), 0});
      lane = core.rays.end() - 1;
    }
    lane->free_at = slice.end;
    return lane->id;
  }
  /// Adds a counter to the process shared by all cores and returns the counter's track; add_core_counter() adds one to
  /// the process of a core.
  std::uint64_t add_shared_counter(const std::string& name, const std::string& unit) {
    return create_track(shared_process(), name, kOfCounters, unit);
  }
  std::uint64_t add_core_counter(std::uint32_t core, const std::string& name, const std::string& unit) {
    return create_track(process_of(core), name, kOfCounters, unit);
  }
  /// Adds the descriptors of all tracks in use to the trace, processes first.
  void write_descriptors(TracePackets& to) const {
    for (std::uint32_t core = 0; core < cores_.size(); ++core) {
      to.add_process(process_of(core), fmt::format("core {}", core), static_cast<std::int32_t>(core));
    }
    to.add_process(shared_process(), "shared", static_cast<std::int32_t>(cores_.size()));
    for (const TimelineTrack& track : tracks_) to.add_track(track);
  }

 private:
  struct Lane {
    std::uint64_t id = 0;
    sim::Time free_at = 0;
  };
  struct Core {
    std::uint64_t srp = 0, dma = 0;
    std::vector<std::uint64_t> slots;
    std::vector<Lane> rays;
  };
  std::uint64_t process_of(std::uint32_t core) const { return core + 1; }
  std::uint64_t shared_process() const { return cores_.size() + 1; }
  std::uint64_t create_track(std::uint64_t parent, std::string name, std::int32_t rank, std::string unit = {}) {
    const std::uint64_t id = shared_process() + tracks_.size() + 1;
    tracks_.push_back({id, parent, std::move(name), rank, std::move(unit)});
    return id;
  }

  std::vector<Core> cores_;
  std::uint64_t builder_ = 0;
  std::vector<TimelineTrack> tracks_;
};

}  // namespace tools::perfetto
