#pragma once
#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/timeline/recorder.h"

namespace tools {

/// Texts that events refer to by number.
class InternedTexts {
 public:
  std::uint64_t number_of(std::string_view text) {
    return numbers_.try_emplace(std::string(text), numbers_.size() + 1).first->second;
  }
  const std::map<std::string, std::uint64_t>& all_texts() const { return numbers_; }

 private:
  std::map<std::string, std::uint64_t> numbers_;
};

/// A track of the timeline: slices, or a counter if it has a unit.
struct TimelineTrack {
  std::uint64_t id = 0, parent = 0;
  std::string name;
  std::int32_t rank = 0;  ///< among its siblings
  std::string unit = {};
};

/// Serialised packets of a Perfetto trace. Times are in nanoseconds, rounded down.
class TracePackets {
 public:
  /// Adds a process for a part of the machine, the parent of its tracks.
  void add_process(std::uint64_t id, std::string_view name, std::int32_t rank);
  void add_track(const TimelineTrack& track);
  /// Begins a slice. `flow`: the slice's flow; 0: none.
  void begin_slice(std::uint64_t time, std::uint64_t track, std::string_view name, std::string_view category,
                   std::uint64_t flow, std::initializer_list<std::pair<std::string_view, std::uint64_t>> notes);
  void end_slice(std::uint64_t time, std::uint64_t track);
  void add_count(std::uint64_t time, std::uint64_t track, double value);

  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }
  /// Returns the first packet of a file, with the texts that the packets of `other` refer to.
  static std::string texts_of(const TracePackets& other);

 private:
  void add_packet(auto&& fill);

  std::string bytes_;
  InternedTexts names_, categories_, notes_;
};

constexpr std::uint64_t to_nanoseconds(sim::Time time) { return time / sim::kFemtosecondsPerNanosecond; }

/// Tracks of a timeline: a process for each core, and one shared by all.
class TimelineTracks {
 public:
  static constexpr std::uint64_t kLongestId = 0xffffffff;  ///< no id takes more bytes than this one

  explicit TimelineTracks(std::uint32_t cores) : cores_(cores) {}

  /// Returns the track of a slice. Call it for a core's slices in the order of their begin: overlapping batches of rays
  /// get different tracks.
  std::uint64_t track_of(const RecordedSlice& slice);
  /// Adds a counter to the process shared by all cores, or to a core; returns its track.
  std::uint64_t shared_counter(const std::string& name, const std::string& unit);
  std::uint64_t core_counter(std::uint32_t core, const std::string& name, const std::string& unit);
  /// Writes all tracks in use, processes first.
  void write_descriptors(TracePackets& to) const;

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
  std::uint64_t new_track(std::uint64_t parent, std::string name, std::int32_t rank, std::string unit = {});

  std::vector<Core> cores_;
  std::vector<TimelineTrack> tracks_;
};

}  // namespace tools
