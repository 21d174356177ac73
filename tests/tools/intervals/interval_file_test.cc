#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "tools/intervals/intervals.h"
#include "traces/trace_file/bytes.h"
#include "traces/trace_file/packing.h"

// Tests of the file of intervals, byte by byte, as specified in docs/intervals.md.

namespace tools {
namespace {

constexpr std::string_view kMagic = "raywatt-intervals/1\n";

std::vector<sim::UnitReport> two_units() {
  sim::UnitReport a, b;
  a.path = "core0.srp";
  a.cycles_by_reason = {{"idle", 0}, {"running", 0}};
  a.counters = {{"items", "", 0, "", sim::CounterKind::kSum}, {"most", "", 0, "", sim::CounterKind::kPeak}};
  b.path = "l2.bank0";
  b.cycles_by_reason = {{"idle", 0}};
  return {a, b};
}

/// Returns records of five random growing values, over `rows` intervals of 10 fs.
sim::Intervals grown(std::size_t rows, std::uint64_t seed) {
  sim::Intervals intervals(10);
  intervals.allocate_rows(5);
  std::uint64_t values[5] = {};
  const auto fill = [&](std::uint64_t* row, std::size_t i) {
    for (std::size_t v = 0; v < 5; ++v) row[v] = values[v] += v == 4 ? 0 : sim::hash(seed, i, v) >> (v * 20);
  };
  for (std::size_t i = 0; i + 1 < rows; ++i) fill(intervals.add_next_row(), i);
  fill(intervals.add_last_row(10 * rows - 3), rows);
  return intervals;
}

std::string file_of(const std::vector<sim::Intervals>& frames) {
  IntervalPacker packer;
  std::uint32_t number = 7;
  for (const sim::Intervals& frame : frames) packer.add(number++, frame);
  return packer.file_bytes(two_units());
}
std::string file_of(sim::Intervals frame) {
  std::vector<sim::Intervals> frames;
  frames.push_back(std::move(frame));
  return file_of(frames);
}

TEST(IntervalFile, IsReadAsItWasWritten) {
  std::vector<sim::Intervals> written;
  written.push_back(grown(1, 1));
  written.push_back(grown(100, 2));
  written.push_back(grown(17, 3));
  const IntervalFile file = read_intervals(file_of(written));
  ASSERT_EQ(file.units.size(), 2U);
  EXPECT_EQ(file.units[0].path, "core0.srp");
  EXPECT_EQ(file.units[0].reasons, (std::vector<std::string>{"idle", "running"}));
  EXPECT_EQ(file.units[0].counters[1].name, "most");
  EXPECT_EQ(file.units[0].counters[1].kind, sim::CounterKind::kPeak);
  ASSERT_EQ(file.frames.size(), written.size());
  for (std::size_t f = 0; f < written.size(); ++f) {
    const IntervalFrame& frame = file.frames[f];
    EXPECT_EQ(frame.frame, 7 + f);
    ASSERT_EQ(frame.rows, written[f].size());
    EXPECT_EQ(frame.length, 10U);
    EXPECT_EQ(frame.end, written[f].end());
    for (std::size_t i = 0; i < frame.rows; ++i) {
      EXPECT_TRUE(std::ranges::equal(frame.row(i), written[f].row(i))) << i;
      EXPECT_EQ(frame.interval_end(i), written[f].interval_end(i));
    }
  }
}

TEST(IntervalFile, MergesNeighboursUntilThereAreFewEnough) {
  const IntervalFrame frame = read_intervals(file_of(grown(11, 4))).frames.front();
  const IntervalFrame six = frame.with_merged_intervals(6), three = frame.with_merged_intervals(3),
                      one = frame.with_merged_intervals(1);
  ASSERT_EQ(six.rows, 6U);
  EXPECT_EQ(six.length, 20U);
  ASSERT_EQ(three.rows, 3U);
  ASSERT_EQ(one.rows, 1U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(std::ranges::equal(six.row(i), frame.row(2 * i + 1))) << i;
  for (const IntervalFrame* merged : {&six, &three, &one}) {
    EXPECT_TRUE(std::ranges::equal(merged->row(merged->rows - 1), frame.row(10)));
    EXPECT_EQ(merged->interval_end(merged->rows - 1), frame.end);
  }
  EXPECT_EQ(frame.with_merged_intervals(11).rows, 11U);
}

/// Returns a file written only from the specification: names, then one frame of two intervals.
struct ByHand {
  std::string magic{kMagic};
  std::uint64_t frames = 1, units = 1, reasons = 1, counters = 0, length = 10, end = 15, rows = 2, total = 15;
  std::string after_names{}, after_frame{};

  std::string bytes() const {
    std::string names = magic, frame;
    traces::ByteWriter n(names), f(frame);
    for (const std::uint64_t number : {frames, units}) n.write_number(number);
    n.write_number(1), names += "u", n.write_number(reasons), n.write_number(1), names += "r", n.write_number(counters);
    for (const std::uint64_t number :
         {std::uint64_t{0}, length, end, rows, total, std::uint64_t{10}, std::uint64_t{5}}) {
      f.write_number(number);
    }
    traces::Packer packer;
    std::string all(packer.pack_block(names + after_names));
    return all += packer.pack_block(frame + after_frame);
  }
};

void expect_refused(const ByHand& file, const std::string& why) {
  try {
    read_intervals(file.bytes());
    ADD_FAILURE() << "read, not refused: " << why;
  } catch (const sim::InputError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
}

TEST(IntervalFile, CanBeWrittenByHand) {
  const IntervalFile file = read_intervals(ByHand{}.bytes());
  EXPECT_EQ(file.units.front().reasons.front(), "r");
  ASSERT_EQ(file.frames.front().rows, 2U);
  EXPECT_EQ(file.frames.front().row(0)[0], 10U);
  EXPECT_EQ(file.frames.front().row(1)[0], 15U);
}

TEST(IntervalFile, IsRefusedInOneLineForWhatNoRunWrites) {
  expect_refused({.magic = "raywatt-intervals/2\n"}, "is of another version");
  expect_refused({.magic = "something else\n"}, "is no file of intervals");
  expect_refused({.frames = 2}, "damaged");
  expect_refused({.frames = 0}, "has more than its frames");
  expect_refused({.units = 1U << 20}, "the number of units is out of range");
  expect_refused({.units = 2}, "ends early");
  expect_refused({.reasons = 1U << 20}, "the number of reasons is out of range");
  expect_refused({.counters = std::uint64_t{1} << 60}, "the number of counters is out of range");
  expect_refused({.length = 0}, "do not fill their frame");
  expect_refused({.end = 0}, "do not fill their frame");
  expect_refused({.end = 21}, "do not fill their frame");
  expect_refused({.end = 10}, "do not fill their frame");
  expect_refused({.length = ~std::uint64_t{0}}, "the length of an interval is out of range");
  expect_refused({.rows = 0}, "do not fill their frame");
  expect_refused({.rows = 4096}, "the number of intervals is out of range");
  expect_refused({.total = 16}, "do not add up");
  expect_refused({.after_names = "x"}, "more than its names");
  expect_refused({.after_frame = "x"}, "more in a frame");
}

TEST(IntervalFile, IsRefusedWhenAnyByteOfItIsGoneOrChanged) {
  const std::string whole = file_of(grown(9, 5));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_THROW(read_intervals(std::string_view(whole).substr(0, i)), sim::InputError) << i;
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x55);
    try {
      read_intervals(changed);  // zstd has unused bits
    } catch (const sim::InputError&) {
    }
  }
  EXPECT_THROW(read_intervals(whole + whole), sim::InputError);
}

}  // namespace
}  // namespace tools
