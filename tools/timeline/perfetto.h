#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include <protozero/pbf_writer.hpp>

namespace tools {

/// Field numbers of the Perfetto messages that a timeline uses, from its published protos:
/// protos/perfetto/trace/trace_packet.proto, track_event/*.proto, interned_data/interned_data.proto.
namespace perfetto {

using Tag = protozero::pbf_tag_type;
using Writer = protozero::pbf_writer;

inline constexpr Tag kTracePacket = 1;

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
  static constexpr Tag kId = 1, kText = 2;  ///< fields of each entry
};

}  // namespace perfetto
}  // namespace tools
