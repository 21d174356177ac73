#include "tools/intervals/interval_file.h"

#include <algorithm>
#include <memory>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/trace_file/bytes.h"
#include "traces/trace_file/packing.h"

namespace tools {
namespace {

constexpr std::string_view kMagic = "raywatt-intervals/1\n", kKind = "raywatt-intervals/";
constexpr std::uint64_t kMostUnits = 1U << 16, kMostNames = 1U << 10, kLongestName = 256;
constexpr std::uint64_t kMostFrames = 1'000'000, kMostValues = 1U << 26;  ///< in all frames together
constexpr int kLevel = -20;  ///< zstd: a third of the instructions of level 1, files half as large again
constexpr std::uint64_t kMostNamesBytes = 1U << 26, kLongestVarint = 10;

/// Writes a number; the caller has reserved the room.
char* write_number(char* at, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) *at++ = static_cast<char>(value | 0x80U);
  *at++ = static_cast<char>(value);
  return at;
}

/// Writes a value of a unit over all intervals: its total, then, unless that is 0, its increase in each interval.
char* write_column(char* at, const sim::Intervals& intervals, std::size_t column) {
  const std::size_t rows = intervals.size(), width = intervals.row_width();
  const std::uint64_t* value = intervals.row(0).data() + column;
  const std::uint64_t total = value[(rows - 1) * width];
  at = write_number(at, total);
  if (total == 0) return at;
  std::uint64_t before = 0;
#pragma GCC unroll 8  // a quarter fewer instructions
  for (std::size_t row = 0; row < rows; ++row, value += width) {
    const std::uint64_t came = *value - before;
    before = *value;
    if (came < 0x80) {
      *at++ = static_cast<char>(came);
    } else {
      at = write_number(at, came);
    }
  }
  return at;
}

void read_column(traces::ByteReader& in, IntervalFrame& frame, std::size_t column) {
  const std::uint64_t total = in.read_number();
  if (total == 0) return;
  std::uint64_t sum = 0;
  for (std::size_t row = 0; row < frame.rows; ++row) {
    sum += in.read_number();
    frame.values[row * frame.width + column] = sum;
  }
  if (sum != total) throw sim::InputError("has intervals that do not add up");
}

IntervalFrame read_frame(traces::ByteReader& in, std::size_t width, std::uint64_t most_values) {
  IntervalFrame frame;
  frame.frame = in.read_number32(kMostFrames, "the number of a frame");
  frame.length = in.read_number(sim::kNever, "the length of an interval");
  frame.end = in.read_number(sim::kNever, "the end of a frame");
  frame.rows = in.read_number(sim::Intervals::kMost, "the number of intervals");
  frame.width = width;
  if (frame.rows == 0 || frame.length == 0 || frame.end == 0 || (frame.end - 1) / frame.length != frame.rows - 1) {
    throw sim::InputError("has intervals that do not fill their frame");
  }
  if (frame.rows * width > most_values) throw sim::InputError("has more intervals than any run");
  frame.values.resize(frame.rows * width);
  for (std::size_t column = 0; column < width; ++column) read_column(in, frame, column);
  if (in.bytes_left() != 0) throw sim::InputError("has more in a frame than its intervals");
  return frame;
}

std::string read_name(traces::ByteReader& in) {
  return sim::printable(std::string(in.read_bytes(in.read_number(kLongestName, "the length of a name"))));
}

IntervalUnit read_unit(traces::ByteReader& in) {
  IntervalUnit unit;
  unit.path = read_name(in);
  unit.reasons.resize(in.read_number(kMostNames, "the number of reasons"));
  for (std::string& reason : unit.reasons) reason = read_name(in);
  unit.counters.resize(in.read_number(kMostNames, "the number of counters"));
  for (IntervalUnit::Counter& counter : unit.counters) {
    counter.name = read_name(in);
    counter.kind = static_cast<sim::CounterKind>(in.read_number(2, "the kind of a counter"));
  }
  return unit;
}

void write_name(traces::ByteWriter& out, std::string& bytes, const std::string& name) {
  out.write_number(name.size());
  bytes += name;
}

}  // namespace

std::vector<IntervalUnit> interval_units(std::span<const sim::UnitReport> units) {
  std::vector<IntervalUnit> all;
  for (const sim::UnitReport& unit : units) {
    IntervalUnit& to = all.emplace_back(IntervalUnit{unit.path, {}, {}});
    for (const auto& [reason, cycles] : unit.cycles_by_reason) to.reasons.push_back(reason);
    for (const sim::CounterReport& counter : unit.counters) to.counters.push_back({counter.name, counter.kind});
  }
  return all;
}

IntervalFrame IntervalFrame::merged_to(std::size_t most) const {
  IntervalFrame less = *this;
  while (less.rows > std::max<std::size_t>(most, 1)) {
    const std::size_t pairs = (less.rows + 1) / 2;
    for (std::size_t i = 0; i < pairs; ++i) {
      std::ranges::copy(less.row(std::min(2 * i + 1, less.rows - 1)), less.values.data() + i * width);
    }
    less.rows = pairs;
    less.length *= 2;
    less.values.resize(pairs * width);
  }
  return less;
}

sim::Intervals intervals_of_frame(std::uint32_t frames) {
  constexpr std::size_t kLeast = 16;
  return sim::Intervals(sim::Intervals::kFirstLength, std::max(kLeast, sim::Intervals::kMost / frames / 2 * 2));
}

void IntervalPacker::add(std::uint32_t frame, const sim::Intervals& intervals) {
  const auto bytes =
      std::make_unique_for_overwrite<char[]>(kLongestVarint * (4 + (intervals.size() + 1) * intervals.row_width()));
  char* at = bytes.get();
  for (const std::uint64_t number :
       {std::uint64_t{frame}, intervals.interval_length(), intervals.end(), intervals.size()}) {
    at = write_number(at, number);
  }
  for (std::size_t column = 0; column < intervals.row_width(); ++column) at = write_column(at, intervals, column);
  packed_ += traces::Packer(kLevel).pack_block({bytes.get(), static_cast<std::size_t>(at - bytes.get())});
  frames_ += 1;
}

std::string IntervalPacker::file_bytes(std::span<const sim::UnitReport> units) const {
  std::string bytes(kMagic);
  traces::ByteWriter out(bytes);
  out.write_number(frames_);
  out.write_number(units.size());
  for (const IntervalUnit& unit : interval_units(units)) {
    write_name(out, bytes, unit.path);
    out.write_number(unit.reasons.size());
    for (const std::string& reason : unit.reasons) write_name(out, bytes, reason);
    out.write_number(unit.counters.size());
    for (const IntervalUnit::Counter& counter : unit.counters) {
      write_name(out, bytes, counter.name);
      out.write_number(static_cast<std::uint64_t>(counter.kind));
    }
  }
  return std::string(traces::Packer().pack_block(bytes)) + packed_;
}

IntervalFile read_intervals(std::string_view bytes) {
  traces::Unpacker unpacker;
  const auto next = [&](std::uint64_t most) {
    const std::string_view block = bytes.substr(0, traces::Unpacker::size_of(bytes));
    bytes.remove_prefix(block.size());
    return unpacker.unpack_block(block, most);
  };
  IntervalFile file;
  const std::string_view names = next(kMostNamesBytes);
  if (!names.starts_with(kMagic)) {
    throw sim::InputError(names.starts_with(kKind) ? "is of another version; allowed: raywatt-intervals/1"
                                                   : "is no file of intervals");
  }
  traces::ByteReader in(names.substr(kMagic.size()));
  const std::uint64_t frames = in.read_number(kMostFrames, "the number of frames");
  const std::uint64_t units = in.read_number(kMostUnits, "the number of units");
  std::size_t width = 0;
  for (std::uint64_t u = 0; u < units; ++u) width += file.units.emplace_back(read_unit(in)).value_count();
  if (in.bytes_left() != 0) throw sim::InputError("has more than its names before its frames");
  std::uint64_t values_left = kMostValues;
  for (std::uint64_t f = 0; f < frames; ++f) {
    const std::uint64_t most = std::min<std::uint64_t>(values_left, 2 * sim::Intervals::kMostValues);
    traces::ByteReader of_frame(next(kLongestVarint * (4 + width + most)));
    file.frames.push_back(read_frame(of_frame, width, most));
    values_left -= file.frames.back().values.size();
  }
  if (!bytes.empty()) throw sim::InputError("has more than its frames");
  return file;
}

}  // namespace tools
