#include "tools/intervals/run_intervals.h"

#include <algorithm>
#include <functional>
#include <limits>

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
#include "tools/analysis/limiter.h"
#include "tools/analysis/units.h"
#include "tools/pricing/reported_units.h"
#include "tools/run/frame/idle_machine.h"
#include "tools/run/frame/power.h"

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

namespace {

using Reports = std::vector<sim::UnitReport>;

constexpr double kPercent = 100;
constexpr double kGigabytesPerByteOverFemtosecond = 1e6;
constexpr double kMillionsPerSecondPerOneOverFemtosecond = 1e9;

/// The frame's energy formula, applied to the counts until the end of an interval.
class EnergyUntil {
 public:
  explicit EnergyUntil(const RunIntervals& run)
      : device_(hw::dram_energy_events(run.config().gpu->dram)),
        formula_(run.units(), run.config().energy, device_, 0, power_scales(run.config())) {}

  const sim::EnergyFormula& formula_at(const IntervalFrame& frame, std::size_t interval, const Reports& until) {
    formula_.set_counts(until, frame.end_of(interval));
    return formula_;
  }

 private:
  std::map<std::string, sim::DeviceEvent> device_;
  sim::EnergyFormula formula_;
};

/// Series under construction, in the order in which their names first appear.
class Growing {
 public:
  explicit Growing(std::vector<IntervalSeries>& series) : series_(series) {}
  void next_interval() { at_ = 0; }
  void add(std::string_view group, std::string_view name, std::string_view unit, double value) {
    if (at_ == series_.size()) series_.push_back({std::string(group), std::string(name), std::string(unit), {}});
    series_[at_++].values.push_back(value);
  }

 private:
  std::vector<IntervalSeries>& series_;
  std::size_t at_ = 0;
};

/// Builds one frame's table, interval by interval.
class Table {
 public:
  Table(const RunIntervals& run, const IntervalFrame& frame, sim::BandMember side)
      : run_(run),
        frame_(frame),
        side_(side),
        energy_(run),
        until_(run.units().begin(), run.units().end()),
        within_(until_),
        series_(table_.series) {}

  IntervalTable make_table() {
    for (std::size_t i = 0; i < frame_.rows; ++i) {
      RunIntervals::set_until(frame_, i, until_);
      RunIntervals::set_within(frame_, i, within_);
      table_.begin_us.push_back(static_cast<double>(frame_.begin_of(i)) / sim::kFemtosecondsPerMicrosecond);
      table_.end_us.push_back(static_cast<double>(frame_.end_of(i)) / sim::kFemtosecondsPerMicrosecond);
      time_ = static_cast<double>(frame_.end_of(i) - frame_.begin_of(i));
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
    const sim::EnergyFormula& energy = energy_.formula_at(frame_, interval, until_);
    std::vector<double> blocks = energy.block_energies(side_), kinds = energy.kind_energies(side_);
    blocks.push_back(energy.total_pj(side_));
    if (blocks_before_.empty()) blocks_before_.resize(blocks.size()), kinds_before_.resize(kinds.size());
    const auto watts = [&](double until, double before) {
      return (until - before) / time_ * sim::kWattsPerPicojouleOverFemtosecond;
    };
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const bool is_sum = b + 1 == blocks.size();
      series_.add("power", is_sum ? "total" : energy.block_names()[b], "W", watts(blocks[b], blocks_before_[b]));
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
    add("dram_read", channels.counted(&Dram::reads), run_.config().gpu->dram.line.bytes);
    add("dram_write", channels.counted(&Dram::writes), run_.config().gpu->dram.line.bytes);
    add("l2_read", Units<hw::L2Bank>(within_).counted(&hw::L2Bank::Stats::reads), hw::kLineBytes);
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
    add("node", trvs.counted(&hw::Trv::Stats::l1_hits), trvs.counted(&hw::Trv::Stats::l1_accesses));
    add("triangle", ists.counted(&hw::Ist::Stats::l1_hits), ists.counted(&hw::Ist::Stats::l1_accesses));
    add("data", srps.counted(&hw::Srp::Stats::cache_hits), srps.counted(&hw::Srp::Stats::cache_accesses));
    add("l2", banks.counted(&hw::L2Bank::Stats::hits), banks.counted(&hw::L2Bank::Stats::reads));
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
    const auto traced = static_cast<double>(Units<hw::Srp>(within_).counted(&Srp::hits));
    series_.add("rays", "traced", "Mrays/s", traced / time_ * kMillionsPerSecondPerOneOverFemtosecond);
    const Units<hw::Srp> srps(until_);
    const std::uint64_t sent = srps.counted(&Srp::rays), back = srps.counted(&Srp::hits);
    series_.add("rays_in_flight", "tni", "rays", static_cast<double>(sent - back));
  }

  const RunIntervals& run_;
  const IntervalFrame& frame_;
  const sim::BandMember side_;
  EnergyUntil energy_;
  Reports until_, within_;
  IntervalTable table_;
  Growing series_;
  double time_ = 1;  ///< length of the interval in fs
  std::vector<double> blocks_before_, kinds_before_;
};

}  // namespace

const IntervalSeries* IntervalTable::find(std::string_view group, std::string_view name) const {
  const auto found =
      std::ranges::find_if(series, [&](const IntervalSeries& s) { return s.group == group && s.name == name; });
  return found == series.end() ? nullptr : &*found;
}

IntervalTable derive_table(const RunIntervals& run, const IntervalFrame& frame, sim::BandMember side,
                           std::size_t most) {
  return Table(run, frame.merged_to(most), side).make_table();
}

IntervalEnergy energy_until(const RunIntervals& run, const IntervalFrame& frame, sim::BandMember side) {
  EnergyUntil energy(run);
  Reports until(run.units().begin(), run.units().end());
  IntervalEnergy all;
  for (std::size_t i = 0; i < frame.rows; ++i) {
    RunIntervals::set_until(frame, i, until);
    const sim::EnergyFormula& formula = energy.formula_at(frame, i, until);
    all.blocks = formula.block_names();
    all.until_pj.push_back(formula.block_energies(side));
  }
  return all;
}

}  // namespace tools
