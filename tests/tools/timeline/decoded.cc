#include "tests/tools/timeline/decoded.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "sim/io/file.h"
#include "tests/tools/program.h"

namespace tools::test {
namespace {

/// A message in protoc's text format: a list of fields, each with a plain value or a message.
struct Message {
  struct Field {
    std::string name, value;
    std::vector<Message> message;  ///< the message; empty for a plain value
  };
  std::vector<Field> fields;

  const Field* find(const std::string& name) const {
    const auto found = std::ranges::find(fields, name, &Field::name);
    return found == fields.end() ? nullptr : &*found;
  }
  std::string text(const std::string& name) const {
    const Field* field = find(name);
    if (field == nullptr) return {};
    const std::string& value = field->value;
    return value.starts_with('"') ? value.substr(1, value.size() - 2) : value;
  }
  std::uint64_t number(const std::string& name) const {
    const std::string value = text(name);
    return value.empty() ? 0 : std::stoull(value);
  }
};

Message read_message(std::istream& in) {
  Message message;
  for (std::string line; std::getline(in, line);) {
    line.erase(0, line.find_first_not_of(' '));
    if (line == "}") return message;
    if (line.ends_with(" {")) {
      message.fields.push_back({line.substr(0, line.size() - 2), {}, {}});
      message.fields.back().message.push_back(read_message(in));
      continue;
    }
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) throw std::runtime_error("protoc says: " + line);
    message.fields.push_back({line.substr(0, colon), line.substr(colon + 2), {}});
  }
  return message;
}

using Texts = std::map<std::uint64_t, std::string>;

class Reader {
 public:
  DecodedTimeline read(const Message& trace) {
    for (const Message::Field& packet : trace.fields) {
      if (packet.name != "packet") complain("a field that is no packet: " + packet.name);
      read_packet(packet.message.front());
    }
    for (const auto& [track, open] : open_) {
      if (!open.empty()) complain("a slice does not end: " + open.back().name);
    }
    return std::move(out_);
  }

 private:
  void complain(const std::string& what) {
    if (out_.problem.empty()) out_.problem = what;
  }

  void read_packet(const Message& packet) {
    if (packet.number("trusted_packet_sequence_id") == 0) complain("a packet of no sequence");
    for (const Message::Field& field : packet.fields) {
      if (field.name == "interned_data") read_texts(field.message.front());
      if (field.name == "track_descriptor") read_track(field.message.front());
      if (field.name == "track_event") read_event(packet.number("timestamp"), field.message.front());
    }
  }

  void read_texts(const Message& data) {
    for (const Message::Field& field : data.fields) {
      Texts& texts = field.name == "event_names" ? names_ : field.name == "event_categories" ? categories_ : notes_;
      texts[field.message.front().number("iid")] = field.message.front().text("name");
    }
  }

  void read_track(const Message& track) {
    if (const Message::Field* process = track.find("process")) {
      out_.processes[track.number("uuid")] = process->message.front().text("process_name");
      return;
    }
    DecodedTrack& known = out_.tracks[track.number("uuid")];
    known.name = track.text("name");
    known.parent = track.number("parent_uuid");
    if (const Message::Field* counter = track.find("counter")) known.unit = counter->message.front().text("unit_name");
  }

  void read_event(std::uint64_t time, const Message& event) {
    const std::uint64_t track = event.number("track_uuid");
    if (!out_.tracks.contains(track)) complain("an event on no track");
    if (time < last_[track]) complain("an event of a track before one that stands before it");
    last_[track] = time;
    const std::string type = event.text("type");
    std::vector<DecodedSlice>& open = open_[track];
    if (type == "TYPE_COUNTER") {
      out_.counters[track].emplace_back(time, std::stod(event.text("double_counter_value")));
    } else if (type == "TYPE_SLICE_END") {
      if (open.empty()) return complain("an end without a begin");
      open.back().end = time;
      out_.slices.push_back(open.back());
      open.pop_back();
    } else {
      open.push_back({names_[event.number("name_iid")],
                      categories_[event.number("category_iids")],
                      track,
                      time,
                      0,
                      open.size(),
                      {},
                      {}});
      for (const Message::Field& field : event.fields) {
        if (field.name == "flow_ids") open.back().flows.push_back(std::stoull(field.value));
        if (field.name != "debug_annotations") continue;
        const Message& note = field.message.front();
        open.back().notes[notes_[note.number("name_iid")]] = note.number("uint_value");
      }
    }
  }

  DecodedTimeline out_;
  Texts names_, categories_, notes_;
  std::map<std::uint64_t, std::vector<DecodedSlice>> open_;
  std::map<std::uint64_t, std::uint64_t> last_;  ///< time of the last event of each track
};

}  // namespace

std::string DecodedTimeline::path(const DecodedSlice& slice) const {
  const DecodedTrack& track = tracks.at(slice.track);
  return processes.at(track.parent) + "/" + track.name;
}

DecodedTimeline decode_timeline(const std::string& bytes) {
  const ::test::TempFolder folder;
  const std::filesystem::path file = folder.write("timeline.pftrace", bytes);
  const std::string command =
      "protoc --decode=raywatt.test.Trace -I tests/tools/timeline timeline.proto <" + file.string();
  const ::test::ProcessResult ending = ::test::raywatt({"-c", command}, {.program = "/bin/sh"});
  DecodedTimeline out;
  if (ending.exit != 0) {
    out.problem = ending.err;
    return out;
  }
  std::istringstream text(ending.out);
  return Reader().read(read_message(text));
}

}  // namespace tools::test
