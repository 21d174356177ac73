#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tools::test {

/// A slice of a timeline, decoded from the output of `protoc --decode`.
struct DecodedSlice {
  std::string name, category;
  std::uint64_t track = 0, begin = 0, end = 0;
  std::size_t depth = 0;  ///< number of slices on its track that enclose it
  std::map<std::string, std::uint64_t> notes;
  std::vector<std::uint64_t> flows;
};
struct DecodedTrack {
  std::string name, unit;
  std::uint64_t parent = 0;
};
struct DecodedTimeline {
  std::map<std::uint64_t, std::string> processes;
  std::map<std::uint64_t, DecodedTrack> tracks;
  std::vector<DecodedSlice> slices;  ///< sorted by end time
  std::map<std::uint64_t, std::vector<std::pair<std::uint64_t, double>>>
      counters;         ///< times and values of each counter track
  std::string problem;  ///< what is wrong with the timeline; empty if it is valid

  /// Returns the process and the track of a slice by name: "core 0/SRP".
  std::string path(const DecodedSlice& slice) const;
};

/// Decodes the bytes of a timeline file with protoc and tests/tools/timeline/timeline.proto.
DecodedTimeline decode_timeline(const std::string& bytes);

}  // namespace tools::test
