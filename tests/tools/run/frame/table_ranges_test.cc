#include <algorithm>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/config/config.h"
#include "sim/config/quantity.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "tests/full_size.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/table_warnings.h"

// Tests that each value outside a table causes a warning, on random machines at the ends of their keys' ranges.

namespace tools {
namespace {

/// Smallest and largest size in a table entry, "cache.l1_read" or "tni". Empty for entries without sizes.
struct Range {
  std::uint64_t least = 0, most = 0;
};
std::map<std::string, Range> ranges_of(const std::map<std::string, sim::Band>& table,
                                       std::span<const sim::MeasureUnit> units) {
  std::map<std::string, Range> out;
  for (const auto& [name, figure] : table) {
    const std::size_t at = name.find('@');
    if (at == std::string::npos) continue;
    const std::uint64_t size = sim::read_quantity(name.substr(at + 1), units);
    Range& range = out.try_emplace(name.substr(0, at), Range{size, size}).first->second;
    range = {std::min(range.least, size), std::max(range.most, size)};
  }
  return out;
}

bool is_outside(const std::map<std::string, Range>& ranges, const std::string& name, std::uint64_t value) {
  const auto found = ranges.find(name);
  return found != ranges.end() && (value < found->second.least || value > found->second.most);
}

/// Returns, for each extrapolated value, a text that a warning must contain.
std::vector<std::string> expected_texts(const RunConfig& config) {
  std::vector<std::string> out;
  const auto events = ranges_of(config.energy.events, sim::byte_units());
  const auto arrays = ranges_of(config.area.arrays, sim::byte_units());
  const auto clocks = ranges_of(config.power.dvfs, sim::frequency_units());
  for (const sim::UnitReport& unit : idle_unit_reports(*config.gpu)) {
    if (unit.cache_bytes == 0) continue;
    const std::string size = " has " + sim::quantity_text(unit.cache_bytes, sim::byte_units()) + ", outside ";
    for (const sim::CounterReport& counter : unit.counters) {
      if (is_outside(events, counter.event, unit.cache_bytes)) out.push_back(size);
    }
    if (is_outside(arrays, unit.block, unit.cache_bytes)) out.push_back(size);
  }
  for (const ClockDomain& domain : clock_domains()) {
    const std::uint64_t hz = (config.gpu->clocks.*domain.clock).hz;
    const double volt = voltage_needed(config, domain);
    const std::string clock = "clocks." + std::string(domain.name) + " of ";
    const bool is_scaled = config.power.voltage == sim::Voltage::kDvfs;
    if (is_scaled && is_outside(clocks, std::string(domain.name), hz)) out.push_back(clock);
    if (!is_scaled && volt != config.power.nominal_voltage) out.push_back(clock);
    if (volt > config.power.max_voltage) out.push_back("power.max_voltage: " + clock);
  }
  return out;
}

/// Returns a machine with sizes and clocks at the ends of keys and tables. Throws InputError if they do not fit.
RunConfig draw_config(std::uint64_t seed) {
  std::uint64_t draws = 0;
  const auto one_of = [&](const std::vector<std::string>& choices) {
    return choices[sim::hash(seed, draws++) % choices.size()];
  };
  const std::vector<std::string> sizes = {"512 B", "1 KiB", "4 KiB", "256 KiB", "16 MiB"};
  const std::vector<std::string> clocks = {"1 MHz", "77 MHz", "500 MHz", "1500 MHz", "3000 MHz", "10 GHz"};
  JobOptions options;
  options.sets = {"process=" + one_of({"28nm", "14nm", "7nm", "5nm", "3nm"}),
                  "power.voltage=" + one_of({"nominal", "dvfs"})};
  for (const char* cache : {"tni.trv.l1", "tni.ist.l1", "srp.data_cache"}) {
    options.sets.push_back(std::string(cache) + ".size=" + one_of(sizes));
    options.sets.push_back(std::string(cache) + ".ways=4");
  }
  options.sets.push_back("l2.size=" + one_of({"4 KiB", "1 MiB", "16 MiB"}));
  options.sets.push_back("slc.size=" + one_of({"0 B", "1 MiB", "64 MiB"}));
  options.sets.push_back("l2.hit_cycles=" + one_of({"12", "auto"}));
  options.sets.push_back("tni.trv.l1.hit_cycles=" + one_of({"2", "auto"}));
  for (const char* clock : {"clocks.tni", "clocks.srp", "clocks.l2"}) {
    options.sets.push_back(std::string(clock) + "=" + one_of(clocks));
  }
  return load_run_config(options);
}

TEST(TableRanges, AreNeverLeftWithoutAWarning) {
  std::size_t machines = 0, outside = 0;
  for (std::uint64_t seed = 0; machines < ::test::full_or(200U, 100U); ++seed) {
    ASSERT_LT(seed, 2000U) << "too many are refused";
    RunConfig config;
    try {
      config = draw_config(seed);
    } catch (const sim::InputError&) {
      continue;
    }
    ++machines;
    const std::vector<std::string> lines = technology_table_warnings(config);
    for (const std::string& text : expected_texts(config)) {
      ++outside;
      EXPECT_TRUE(
          std::ranges::any_of(lines, [&](const std::string& line) { return line.find(text) != std::string::npos; }))
          << "seed " << seed << ": " << text;
    }
  }
  EXPECT_GT(outside, 200U) << "the draws reach the ends";
}

/// Tests that arrays from 1 KiB to 16 MiB and clocks up to 1.5 GHz are inside every table.
TEST(TableRanges, CoverArraysFrom1KibTo16MibAndClocksTo1500Mhz) {
  for (const char* process : {"28nm", "14nm", "7nm", "5nm", "3nm"}) {
    JobOptions options;
    options.sets = {std::string("process=") + process};
    const RunConfig config = load_run_config(options);
    for (const auto* table : {&config.energy.events, &config.area.arrays, &config.latency.arrays}) {
      for (const auto& [name, range] : ranges_of(*table, sim::byte_units())) {
        EXPECT_EQ(range.least, 1024U) << process << " " << name;
        EXPECT_EQ(range.most, 16U << 20) << process << " " << name;
      }
    }
    for (const auto& [name, range] : ranges_of(config.power.dvfs, sim::frequency_units())) {
      EXPECT_GE(range.most, 1'500'000'000U) << process << " " << name;
    }
  }
}

/// Tests that energy, area and access time of an array grow with its size.
TEST(TableRanges, RiseWithSize) {
  const RunConfig config = load_run_config({});
  for (const auto* table : {&config.energy.events, &config.area.arrays, &config.latency.arrays}) {
    std::map<std::string, std::map<std::uint64_t, sim::Band>> curves;
    for (const auto& [name, figure] : *table) {
      const std::size_t at = name.find('@');
      if (at != std::string::npos) {
        curves[name.substr(0, at)][sim::read_quantity(name.substr(at + 1), sim::byte_units())] = figure;
      }
    }
    for (const auto& [name, points] : curves) {
      for (auto a = points.begin(), b = std::next(a); b != points.end(); ++a, ++b) {
        EXPECT_LT(a->second.nominal, b->second.nominal) << name << " " << b->first;
        EXPECT_LT(a->second.low, b->second.low) << name << " " << b->first;
        EXPECT_LT(a->second.high, b->second.high) << name << " " << b->first;
      }
    }
  }
}

}  // namespace
}  // namespace tools
