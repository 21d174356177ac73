#include "tools/timeline/trace_packets.h"

#include "tools/timeline/perfetto.h"

namespace tools {
namespace {

using perfetto::Annotation, perfetto::Counter, perfetto::Event, perfetto::Interned, perfetto::Packet, perfetto::Process,
    perfetto::Track, perfetto::Writer;

constexpr std::uint32_t kSequence = 1;

void add_texts(Writer& interned, perfetto::Tag tag, const InternedTexts& texts) {
  for (const auto& [text, number] : texts.all()) {
    Writer entry(interned, tag);
    entry.add_uint64(Interned::kId, number);
    entry.add_string(Interned::kText, text);
  }
}

}  // namespace

void TracePackets::add_packet(auto&& fill) {
  Writer trace(bytes_);
  Writer packet(trace, perfetto::kTracePacket);
  fill(packet);
  packet.add_uint32(Packet::kSequence, kSequence);
  packet.add_uint32(Packet::kSequenceFlags, Packet::kNeedsState);
}

void TracePackets::add_process(std::uint64_t id, std::string_view name, std::int32_t rank) {
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

void TracePackets::add_track(const TimelineTrack& of) {
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

void TracePackets::begin(std::uint64_t time, std::uint64_t track, std::string_view name, std::string_view category,
                         std::uint64_t flow, std::initializer_list<std::pair<std::string_view, std::uint64_t>> notes) {
  add_packet([&](Writer& packet) {
    packet.add_uint64(Packet::kTimestamp, time);
    Writer event(packet, Packet::kTrackEvent);
    event.add_int32(Event::kType, Event::kBegin);
    event.add_uint64(Event::kTrack, track);
    event.add_uint64(Event::kName, names_.number(name));
    event.add_uint64(Event::kCategory, categories_.number(category));
    if (flow != 0) event.add_fixed64(Event::kFlow, flow);
    for (const auto& [note, value] : notes) {
      Writer annotation(event, Event::kAnnotation);
      annotation.add_uint64(Annotation::kName, notes_.number(note));
      annotation.add_uint64(Annotation::kUint, value);
    }
  });
}

void TracePackets::end(std::uint64_t time, std::uint64_t track) {
  add_packet([&](Writer& packet) {
    packet.add_uint64(Packet::kTimestamp, time);
    Writer event(packet, Packet::kTrackEvent);
    event.add_int32(Event::kType, Event::kEnd);
    event.add_uint64(Event::kTrack, track);
  });
}

void TracePackets::count(std::uint64_t time, std::uint64_t track, double value) {
  add_packet([&](Writer& packet) {
    packet.add_uint64(Packet::kTimestamp, time);
    Writer event(packet, Packet::kTrackEvent);
    event.add_int32(Event::kType, Event::kCounter);
    event.add_uint64(Event::kTrack, track);
    event.add_double(Event::kCounterValue, value);
  });
}

std::string TracePackets::texts_of(const TracePackets& other) {
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

}  // namespace tools
