#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/timeline/recorder.h"
#include "tools/timeline/trace_packets.h"

namespace tools {

constexpr std::uint64_t nanoseconds(sim::Time time) { return time / sim::kFemtosecondsPerNanosecond; }

/// Tracks of a timeline: a process for each core, and one that all share.
class TimelineTracks {
 public:
  static constexpr std::uint64_t kLongestId = 0xffffffff;  ///< no id takes more bytes than this one

  explicit TimelineTracks(std::uint32_t cores) : cores_(cores) {}

  /// Track of a slice. Slices of a core come in the order in which they began: batches of rays that overlap have tracks
  /// beside each other.
  std::uint64_t of(const RecordedSlice& slice);
  /// Counter of the process that all cores share, or of a core.
  std::uint64_t shared_counter(const std::string& name, const std::string& unit);
  std::uint64_t core_counter(std::uint32_t core, const std::string& name, const std::string& unit);
  /// Writes all that have been asked for, processes first.
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
