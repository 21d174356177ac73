#include "tools/intervals/run_intervals.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/unit_values.h"
#include "tools/pricing/idle_machine.h"
#include "tools/pricing/reported_units.h"

namespace tools {
namespace {

constexpr std::uint64_t kLargestFile = 1ULL << 30;

std::filesystem::path file_beside(const ReportFile& report) { return report.file.parent_path() / kIntervalFile; }

bool are_named(std::span<const sim::UnitReport> units, std::span<const IntervalUnit> names) {
  const auto same_counter = [](const sim::CounterReport& counter, const IntervalUnit::Counter& named) {
    return counter.name == named.name && counter.kind == named.kind;
  };
  const auto same_reason = [](const auto& why, const std::string& named) { return why.first == named; };
  return std::ranges::equal(units, names, [&](const sim::UnitReport& unit, const IntervalUnit& named) {
    return unit.path == named.path && std::ranges::equal(unit.why, named.reasons, same_reason) &&
           std::ranges::equal(unit.counters, named.counters, same_counter);
  });
}

bool equal_counts(const std::vector<sim::UnitReport>& a, const std::vector<sim::UnitReport>& b) {
  return std::ranges::equal(a, b, [](const sim::UnitReport& x, const sim::UnitReport& y) {
    return x.why == y.why &&
           std::ranges::equal(x.counters, y.counters, {}, &sim::CounterReport::value, &sim::CounterReport::value);
  });
}

}  // namespace

bool RunIntervals::are_beside(const ReportFile& report) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file_beside(report), ignored);
}

RunIntervals RunIntervals::load(const std::filesystem::path& run) { return RunIntervals(load_report(run)); }

RunIntervals::RunIntervals(const ReportFile& report)
    : config_(reported_config(report)), units_(idle_units(*config_.gpu, ReportedCounts(report).has_rasteriser())) {
  const std::filesystem::path file = file_beside(report);
  const auto refuse = [&](const std::string& why) {
    return sim::InputError(fmt::format("{}: {}", sim::printable(file.string()), why));
  };
  if (!are_beside(report)) {
    throw refuse("is not there; allowed: a run without --tile-sampling and --intervals off");
  }
  const std::string bytes = sim::read_file(file, kLargestFile);
  IntervalFile read;
  try {
    read = read_intervals(bytes);
  } catch (const sim::InputError& error) {
    throw refuse(error.what());
  }
  if (!are_named(units_, read.units)) throw refuse("is of another machine than the report beside it");
  frames_ = std::move(read.frames);
  std::vector<sim::UnitReport> reported = units_, sum = units_, one = units_;
  ReportedCounts(report).fill(reported);
  for (const IntervalFrame& frame : frames_) {
    set_until(frame, frame.rows - 1, one);
    sim::add_reports(sum, one);
  }
  if (!equal_counts(sum, reported)) throw refuse("does not add up to the report beside it");
}

void RunIntervals::set_until(const IntervalFrame& frame, std::size_t interval, std::span<sim::UnitReport> units) {
  const std::span<const std::uint64_t> row = frame.row(interval);
  sim::each_value(units, [&](std::uint64_t& value, std::size_t i, sim::CounterKind) { value = row[i]; });
}

void RunIntervals::set_within(const IntervalFrame& frame, std::size_t interval, std::span<sim::UnitReport> units) {
  if (interval == 0) return set_until(frame, interval, units);
  const std::span<const std::uint64_t> row = frame.row(interval), before = frame.row(interval - 1);
  sim::each_value(units, [&](std::uint64_t& value, std::size_t i, sim::CounterKind kind) {
    value = kind == sim::CounterKind::kPeak ? row[i] : row[i] - before[i];
  });
}

}  // namespace tools
