#include "tools/intervals/intervals.h"

#include <algorithm>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/memory/messages.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/energy.h"
#include "sim/report/table.h"
#include "sim/unit_report.h"
#include "tools/analysis/top_down.h"
#include "tools/analysis/units.h"
#include "tools/pricing/reported_units.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"
#include "traces/trace_file/bytes.h"
#include "traces/trace_file/packing.h"

namespace tools {
namespace {

constexpr std::string_view kMagic = "raywatt-intervals/1\n", kKind = "raywatt-intervals/";
constexpr std::uint64_t kMostUnits = 1U << 16, kMostNames = 1U << 10, kLongestName = 256;
constexpr std::uint64_t kMostFrames = 1'000'000, kMostValues = 1U << 26;  ///< limits of an interval file
/// Zstd compression level; compared with level 1: a third of the instructions, files 1.5 times as large.
constexpr int kLevel = -20;
constexpr std::uint64_t kMostNamesBytes = 1U << 26, kLongestVarint = 10;

/// Writes a number in variable-length encoding and returns the address after it; the caller has reserved the space.
char* write_number(char* at, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) *at++ = static_cast<char>(value | 0x80U);
  *at++ = static_cast<char>(value);
  return at;
}

/// Writes one value of a unit: its total over all intervals, then, unless the total is 0, its increase in each
/// interval.
char* write_column(char* at, const sim::Intervals& intervals, std::size_t column) {
  const std::size_t rows = intervals.size(), width = intervals.row_width();
  const std::uint64_t* value = intervals.row(0).data() + column;
  const std::uint64_t total = value[(rows - 1) * width];
  at = write_number(at, total);
  if (total == 0) return at;
  std::uint64_t before = 0;
#pragma GCC unroll 8  // saves a quarter of the instructions
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

std::vector<IntervalUnit> interval_units(std::span<const sim::UnitReport> units) {
  std::vector<IntervalUnit> all;
  for (const sim::UnitReport& unit : units) {
    IntervalUnit& to = all.emplace_back(IntervalUnit{unit.path, {}, {}});
    for (const auto& [reason, cycles] : unit.cycles_by_reason) to.reasons.push_back(reason);
    for (const sim::CounterReport& counter : unit.counters) to.counters.push_back({counter.name, counter.kind});
  }
  return all;
}

}  // namespace

IntervalFrame IntervalFrame::with_merged_intervals(std::size_t max_intervals) const {
  IntervalFrame less = *this;
  while (less.rows > std::max<std::size_t>(max_intervals, 1)) {
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

namespace {

constexpr std::uint64_t kLargestIntervals = 1ULL << 30;

std::filesystem::path interval_file_of(const ReportFile& report) { return report.file.parent_path() / kIntervalFile; }

bool are_named(std::span<const sim::UnitReport> units, std::span<const IntervalUnit> names) {
  const auto same_counter = [](const sim::CounterReport& counter, const IntervalUnit::Counter& named) {
    return counter.name == named.name && counter.kind == named.kind;
  };
  const auto same_reason = [](const auto& why, const std::string& named) { return why.first == named; };
  return std::ranges::equal(units, names, [&](const sim::UnitReport& unit, const IntervalUnit& named) {
    return unit.path == named.path && std::ranges::equal(unit.cycles_by_reason, named.reasons, same_reason) &&
           std::ranges::equal(unit.counters, named.counters, same_counter);
  });
}

bool equal_counts(const std::vector<sim::UnitReport>& a, const std::vector<sim::UnitReport>& b) {
  return std::ranges::equal(a, b, [](const sim::UnitReport& x, const sim::UnitReport& y) {
    return x.cycles_by_reason == y.cycles_by_reason &&
           std::ranges::equal(x.counters, y.counters, {}, &sim::CounterReport::value, &sim::CounterReport::value);
  });
}

}  // namespace

bool RunIntervals::has_intervals(const ReportFile& report) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(interval_file_of(report), ignored);
}

RunIntervals RunIntervals::load(const std::filesystem::path& run) { return RunIntervals(load_report(run)); }

RunIntervals::RunIntervals(const ReportFile& report)
    : config_(reported_config(report)),
      units_(idle_unit_reports(*config_.gpu, ReportedCounts(report).optional_units(), config_.bvh)) {
  const std::filesystem::path file = interval_file_of(report);
  const auto refuse = [&](const std::string& why) {
    return sim::InputError(fmt::format("{}: {}", sim::printable(file.string()), why));
  };
  if (!has_intervals(report)) {
    throw refuse("is not there; allowed: a run without --tile-sampling, --representative and --intervals off");
  }
  const std::string bytes = sim::read_file(file, kLargestIntervals);
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
    set_cumulative_values(frame, frame.rows - 1, one);
    sim::add_reports(sum, one);
  }
  if (!equal_counts(sum, reported)) throw refuse("does not add up to the report beside it");
}

void RunIntervals::set_cumulative_values(const IntervalFrame& frame, std::size_t interval,
                                         std::span<sim::UnitReport> units) {
  const std::span<const std::uint64_t> row = frame.row(interval);
  sim::set_each_value(units, [&](std::uint64_t& value, std::size_t i, sim::CounterKind) { value = row[i]; });
}

void RunIntervals::set_interval_values(const IntervalFrame& frame, std::size_t interval,
                                       std::span<sim::UnitReport> units) {
  if (interval == 0) return set_cumulative_values(frame, interval, units);
  const std::span<const std::uint64_t> row = frame.row(interval), before = frame.row(interval - 1);
  sim::set_each_value(units, [&](std::uint64_t& value, std::size_t i, sim::CounterKind kind) {
    value = kind == sim::CounterKind::kPeak ? row[i] : row[i] - before[i];
  });
}

namespace {

using Reports = std::vector<sim::UnitReport>;

constexpr double kPercent = 100;
constexpr double kGigabytesPerByteOverFemtosecond = 1e6;
constexpr double kMillionsPerSecondPerOneOverFemtosecond = 1e9;

/// Collects series of values; series are in the order in which their names first appear.
class SeriesCollector {
 public:
  explicit SeriesCollector(std::vector<IntervalSeries>& series) : series_(series) {}
  void next_interval() { at_ = 0; }
  void add(std::string_view group, std::string_view name, std::string_view unit, double value) {
    if (at_ == series_.size()) series_.push_back({std::string(group), std::string(name), std::string(unit), {}});
    series_[at_++].values.push_back(value);
  }

 private:
  std::vector<IntervalSeries>& series_;
  std::size_t at_ = 0;
};

/// Computes the metrics of one frame over time, interval by interval.
class Table {
 public:
  Table(const RunIntervals& run, const IntervalFrame& frame, sim::BandMember side)
      : run_(run),
        frame_(frame),
        side_(side),
        device_(hw::dram_energy_events(run.config().gpu->dram)),
        energy_(run.units(), run.config().energy, device_, 0, power_scales(run.config())),
        until_(run.units().begin(), run.units().end()),
        within_(until_),
        series_(table_.series) {}

  IntervalTable make_table() {
    for (std::size_t i = 0; i < frame_.rows; ++i) {
      RunIntervals::set_cumulative_values(frame_, i, until_);
      RunIntervals::set_interval_values(frame_, i, within_);
      table_.begin_us.push_back(static_cast<double>(frame_.interval_begin(i)) / sim::kFemtosecondsPerMicrosecond);
      table_.end_us.push_back(static_cast<double>(frame_.interval_end(i)) / sim::kFemtosecondsPerMicrosecond);
      time_ = static_cast<double>(frame_.interval_end(i) - frame_.interval_begin(i));
      series_.next_interval();
      add_power(i);
      add_bandwidths();
      add_hit_rates();
      add_utilisation();
      add_stack<hw::Trv>("stack.tni");
      add_stack<hw::Ist>("stack.ist");
      add_stack<hw::Srp>("stack.srp");
      add_stack<hw::DramChannel>("stack.dram");
      add_rays();
    }
    return std::move(table_);
  }

 private:
  void add_power(std::size_t interval) {
    energy_.set_counts(until_, frame_.interval_end(interval));
    std::vector<double> blocks = energy_.block_energies(side_), kinds = energy_.kind_energies(side_);
    blocks.push_back(energy_.total_pj(side_));
    if (blocks_before_.empty()) blocks_before_.resize(blocks.size()), kinds_before_.resize(kinds.size());
    const auto watts = [&](double until, double before) {
      return (until - before) / time_ * sim::kWattsPerPicojouleOverFemtosecond;
    };
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const bool is_sum = b + 1 == blocks.size();
      series_.add("power", is_sum ? "total" : energy_.block_names()[b], "W", watts(blocks[b], blocks_before_[b]));
    }
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      series_.add("power_by_kind", sim::EnergyFormula::kKinds[k], "W", watts(kinds[k], kinds_before_[k]));
    }
    blocks_before_ = std::move(blocks);
    kinds_before_ = std::move(kinds);
  }

  void add_bandwidths() {
    using Dram = hw::DramChannel::Stats;
    const Units<hw::DramChannel> channels(within_);
    const auto add = [&](const char* name, std::uint64_t lines, std::uint64_t bytes) {
      series_.add("bandwidth", name, "GB/s",
                  static_cast<double>(lines * bytes) / time_ * kGigabytesPerByteOverFemtosecond);
    };
    add("dram_read", channels.sum_of(&Dram::reads), run_.config().gpu->dram.line.bytes);
    add("dram_write", channels.sum_of(&Dram::writes), run_.config().gpu->dram.line.bytes);
    add("l2_read", Units<hw::L2Bank>(within_).sum_of(&hw::L2Bank::Stats::reads), hw::kLineBytes);
  }

  void add_hit_rates() {
    const auto add = [&](const char* name, std::uint64_t hits, std::uint64_t accesses) {
      const double rate = accesses == 0 ? std::numeric_limits<double>::quiet_NaN()
                                        : kPercent * static_cast<double>(hits) / static_cast<double>(accesses);
      series_.add("hit_rate", name, "%", rate);
    };
    const Units<hw::Trv> trvs(within_);
    const Units<hw::Ist> ists(within_);
    const Units<hw::Srp> srps(within_);
    const Units<hw::L2Bank> banks(within_);
    add("node", trvs.sum_of(&hw::Trv::Stats::l1_hits), trvs.sum_of(&hw::Trv::Stats::l1_accesses));
    add("triangle", ists.sum_of(&hw::Ist::Stats::l1_hits), ists.sum_of(&hw::Ist::Stats::l1_accesses));
    add("data", srps.sum_of(&hw::Srp::Stats::cache_hits), srps.sum_of(&hw::Srp::Stats::cache_accesses));
    add("l2", banks.sum_of(&hw::L2Bank::Stats::hits), banks.sum_of(&hw::L2Bank::Stats::reads));
  }

  void add_utilisation() {
    const Utilisation used = utilisation_of(within_);
    series_.add("utilisation", "tni", "%", kPercent * used.tni);
    series_.add("utilisation", "srp", "%", kPercent * used.srp);
    series_.add("utilisation", "dram", "%", kPercent * used.dram);
  }

  template <class Unit>
  void add_stack(const char* group) {
    const Units<Unit> units(within_);
    for (std::size_t i = 0; i < Unit::kReasons.size(); ++i) {
      series_.add(group, Unit::kReasons[i].name, "%",
                  kPercent * units.share(static_cast<typename Unit::CycleReason>(i)));
    }
  }

  void add_rays() {
    using Srp = hw::Srp::Stats;
    const auto traced = static_cast<double>(Units<hw::Srp>(within_).sum_of(&Srp::hits));
    series_.add("rays", "traced", "Mrays/s", traced / time_ * kMillionsPerSecondPerOneOverFemtosecond);
    const Units<hw::Srp> srps(until_);
    const std::uint64_t sent = srps.sum_of(&Srp::rays), back = srps.sum_of(&Srp::hits);
    series_.add("rays_in_flight", "tni", "rays", static_cast<double>(sent - back));
  }

  const RunIntervals& run_;
  const IntervalFrame& frame_;
  const sim::BandMember side_;
  const std::map<std::string, sim::DeviceEvent> device_;
  sim::EnergyFormula energy_;
  Reports until_, within_;
  IntervalTable table_;
  SeriesCollector series_;
  double time_ = 1;  ///< length of the current interval in fs
  std::vector<double> blocks_before_, kinds_before_;
};

}  // namespace

const IntervalSeries* IntervalTable::find(std::string_view group, std::string_view name) const {
  const auto found =
      std::ranges::find_if(series, [&](const IntervalSeries& s) { return s.group == group && s.name == name; });
  return found == series.end() ? nullptr : &*found;
}

IntervalTable derive_table(const RunIntervals& run, const IntervalFrame& frame, sim::BandMember side,
                           std::size_t max_intervals) {
  return Table(run, frame.with_merged_intervals(max_intervals), side).make_table();
}

}  // namespace tools
