#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/timeline/recorder.h"
#include "tools/timeline/trace_packets.h"

namespace tools {

constexpr std::uint64_t nanoseconds(sim::Time time) { return time / sim::kFemtosecondsPerNanosecond; }

/// Tracks of a timeline: a process for each core, and one shared by all.
class TimelineTracks {
 public:
  static constexpr std::uint64_t kLongestId = 0xffffffff;  ///< no id takes more bytes than this one

  explicit TimelineTracks(std::uint32_t cores) : cores_(cores) {}

  /// Returns the track of a slice. Call it for a core's slices in the order of their begin: overlapping batches of rays
  /// get different tracks.
  std::uint64_t of(const RecordedSlice& slice);
  /// Adds a counter to the process shared by all cores, or to a core; returns its track.
  std::uint64_t shared_counter(const std::string& name, const std::string& unit);
  std::uint64_t core_counter(std::uint32_t core, const std::string& name, const std::string& unit);
  /// Writes all tracks in use, processes first.
  void describe(TracePackets& to) const;

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
  std::uint64_t process(std::uint32_t core) const { return core + 1; }
  std::uint64_t shared() const { return cores_.size() + 1; }
  std::uint64_t add(std::uint64_t parent, std::string name, std::int32_t rank, std::string unit = {});

  std::vector<Core> cores_;
  std::vector<TimelineTrack> tracks_;
};

}  // namespace tools
