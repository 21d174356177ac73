#include <algorithm>
#include <cmath>
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

// Tests that the tables of each process are those of 14 nm times factors, and that the factors follow the rule of
// docs/processes.md.

namespace tools {
namespace {

RunConfig of_process(const std::string& process, const std::vector<std::string>& more = {}) {
  JobOptions options;
  options.sets = {"process=" + process};
  options.sets.insert(options.sets.end(), more.begin(), more.end());
  return load_run_config(options);
}

/// A semiconductor process and its published properties.
struct Process {
  const char* name;
  double nm;
  double volt, sram_volt;  ///< voltages of the default machine's clocks and of its arrays
  double cell_um2;
  double foundry;  ///< power at equal speed relative to 14 nm, as announced by the foundry
  sim::Band logic_area, array_area;
};
constexpr double kCell14 = 0.064;
constexpr double kAt5Logic = 0.36 / 1.84;
const Process kProcesses[] = {
    {"28nm", 28, 0.947, 0.947, 0.127, 1 / 0.3, {2, 2.1, 2.2}, {1.984, 1.984, 1.984}},
    {"7nm", 7, 0.644, 0.75, 0.027, 0.4, {0.31, 0.36, 0.4}, {0.42, 0.42, 0.55}},
    {"5nm", 5, 0.629, 0.75, 0.021, 0.4 * 0.7, {0.31 / 1.84, kAt5Logic, 0.4 / 1.5}, {0.328, 0.328, 0.43}},
    {"3nm",
     3,
     0.616,
     0.75,
     0.021,
     0.4 * 0.7 * 0.66,
     {0.31 / 1.84 / 1.7, kAt5Logic / 1.6, 0.4 / 1.5 / 1.3},
     {0.311, 0.328, 0.43}}};

/// Returns a gate's energy at a voltage in the unit of Stillmaker & Baas 2017 (high-performance models).
double gate_energy(double nm, double volt) {
  struct Fit {
    double nm, a, b, c;
  };
  constexpr Fit kFits[] = {{32, 0.8367, -0.4341, 0.1701},
                           {20, 0.373, -0.1582, 0.04104},
                           {14, 0.2363, -0.09675, 0.02239},
                           {7, 0.1776, -0.09097, 0.02447}};
  const auto at = [&](const Fit& f) { return f.a * volt * volt + f.b * volt + f.c; };
  if (nm < 7)
    return at(kFits[3]) * std::sqrt(nm / 7);  // not in the paper: proportional to the root of the feature size
  for (std::size_t i = 0; i < std::size(kFits); ++i) {
    if (kFits[i].nm == nm) return at(kFits[i]);
    if (kFits[i].nm > nm) continue;
    const Fit &larger = kFits[i - 1], &smaller = kFits[i];
    const double part = (nm - smaller.nm) / (larger.nm - smaller.nm);
    return part * at(larger) + (1 - part) * at(smaller);
  }
  return 0;
}

/// Returns the capacitance of a gate relative to 14 nm: a power of the feature size that gives 0.45 from 45 to 14 nm.
double gate_capacitance(double nm) { return std::pow(nm / 14, std::log(0.45) / std::log(14.0 / 45)); }

sim::Band logic_factor(const Process& p) {
  const double published = gate_energy(p.nm, p.volt) / gate_energy(14, 0.8);
  const double switched = gate_capacitance(p.nm) * std::pow(p.volt / 0.8, 2);
  return {std::min({published, switched, p.foundry}), std::cbrt(published * switched * p.foundry),
          std::max({published, switched, p.foundry})};
}
sim::Band array_factor(const Process& p) {
  const double logic = logic_factor(p).nominal;
  const double cells = std::sqrt(p.cell_um2 / kCell14) * std::pow(p.sram_volt / 0.8, 2);
  return {std::min(logic, cells), std::sqrt(logic * cells), std::max(logic, cells)};
}
sim::Band wire_factor(const Process& p) {
  const double square = std::pow(p.volt / 0.8, 2);
  const auto at = [&](double area) { return square * std::sqrt(area); };
  return {at(p.logic_area.low), at(p.logic_area.nominal), at(p.logic_area.high)};
}

/// Rounds to three digits, as factors in the tables are.
void expect_rule(const sim::Band& figure, const sim::Band& at_14nm, const sim::Band& rule, const std::string& of) {
  const auto near = [&](double sim::Band::*side) {
    EXPECT_NEAR(figure.*side / (at_14nm.*side) / (rule.*side), 1, 0.006) << of;
  };
  near(&sim::Band::low);
  near(&sim::Band::nominal);
  near(&sim::Band::high);
}

TEST(Processes, EnergiesFollowTheRule) {
  const RunConfig base = of_process("14nm");
  for (const Process& p : kProcesses) {
    const RunConfig config = of_process(p.name);
    const auto of = [&](const char* event) { return config.energy.events.at(event); };
    const auto at_14nm = [&](const char* event) { return base.energy.events.at(event); };
    for (const char* event : {"tni.box_test", "srp.fp_mul", "srp.int_add", "raster.quad"}) {
      expect_rule(of(event), at_14nm(event), logic_factor(p), std::string(p.name) + " " + event);
    }
    for (const char* event : {"cache.l1_read@16KiB", "cache.l2_fill@16MiB", "tile.read@64KiB", "tni.stack_push",
                              "srp.rf_write", "raster.depth_test"}) {
      expect_rule(of(event), at_14nm(event), array_factor(p), std::string(p.name) + " " + event);
    }
    for (const char* event : {"interconnect.line", "dma.line", "tni.hit_route"}) {
      expect_rule(of(event), at_14nm(event), wire_factor(p), std::string(p.name) + " " + event);
    }
    expect_rule(config.energy.flop_clock, base.energy.flop_clock, logic_factor(p), "flop_clock");
    EXPECT_EQ(config.energy.clock_share, base.energy.clock_share);
    EXPECT_EQ(config.energy.flops, base.energy.flops) << "a process moves no flip-flops";
    EXPECT_EQ(config.energy.logic, base.energy.logic) << "areas at 14 nm";
    EXPECT_EQ(config.power.nominal_voltage, p.volt);
  }
}

/// Expects that all entries of a kind have exactly one factor.
TEST(Processes, EntriesOfAKindHaveOneFactor) {
  const RunConfig base = of_process("14nm");
  for (const Process& p : kProcesses) {
    const RunConfig config = of_process(p.name);
    std::map<std::string, int> factors;
    for (const auto& [event, figure] : config.energy.events) {
      factors[std::to_string(figure.nominal / base.energy.events.at(event).nominal)] += 1;
    }
    EXPECT_EQ(factors.size(), 3U) << p.name << ": logic, arrays, wires";
  }
}

TEST(Processes, AreasFollowTheRule) {
  const RunConfig base = of_process("14nm");
  for (const Process& p : kProcesses) {
    const RunConfig config = of_process(p.name);
    expect_rule(config.area.logic_scale, base.area.logic_scale, p.logic_area, std::string(p.name) + " logic");
    for (const char* array : {"tni@16KiB", "l2@256KiB", "l2@16MiB", "tile_buffer@64KiB"}) {
      expect_rule(config.area.arrays.at(array), base.area.arrays.at(array), p.array_area, p.name);
    }
    EXPECT_EQ(config.area.placement, base.area.placement);
  }
}

TEST(Processes, NeedLessVoltageAndEnergyAndAreaTheSmallerTheyAre) {
  const char* const order[] = {"28nm", "14nm", "7nm", "5nm", "3nm"};
  for (std::size_t i = 0; i + 1 < std::size(order); ++i) {
    const RunConfig larger = of_process(order[i]), smaller = of_process(order[i + 1]);
    EXPECT_GT(larger.power.nominal_voltage, smaller.power.nominal_voltage) << order[i];
    for (const auto& [name, volt] : smaller.power.dvfs) {
      EXPECT_GE(larger.power.dvfs.at(name).nominal, volt.nominal) << order[i] << " " << name;
    }
    for (const auto& [name, figure] : smaller.energy.events) {
      EXPECT_GT(larger.energy.events.at(name).nominal, figure.nominal) << order[i] << " " << name;
    }
    EXPECT_GE(larger.area.arrays.at("l2@256KiB").nominal, smaller.area.arrays.at("l2@256KiB").nominal);
    EXPECT_GE(larger.latency.arrays.at("read@16KiB").nominal, smaller.latency.arrays.at("read@16KiB").nominal);
  }
}

// DEVIATIONS.md, D5. TPUv4i (Jouppi et al., ISCA 2021) at 7 nm, pJ; a line of a cache is 8 x 64 bits, a word of the
// tile buffer 2 x 64.
TEST(Processes, PublishedOperationsOf7NmAreInsideTheBandsWithTwoExceptions) {
  const RunConfig config = of_process("7nm");
  const auto is_inside = [&](const char* event, double pj) {
    const sim::Band& band = config.energy.events.at(event);
    return band.low <= pj && pj <= band.high;
  };
  EXPECT_TRUE(is_inside("srp.fp_add", 0.38));
  EXPECT_TRUE(is_inside("srp.fp_mul", 1.31));
  EXPECT_TRUE(is_inside("srp.int_add", 0.03));
  EXPECT_TRUE(is_inside("cache.l2_read@1MiB", 8 * 14));
  EXPECT_FALSE(is_inside("srp.int_mul", 1.48)) << "more than its FP32 multiply";
  EXPECT_FALSE(is_inside("tile.read@8KiB", 2 * 7.5)) << "its arrays hardly fall with size";
}

TEST(Processes, AtTheirNominalClocksWarnOfNothing) {
  for (const char* process : {"28nm", "14nm", "7nm", "5nm", "3nm"}) {
    EXPECT_EQ(technology_table_warnings(of_process(process)), std::vector<std::string>()) << process;
    EXPECT_EQ(technology_table_warnings(of_process(process, {"power.voltage=dvfs"})), std::vector<std::string>())
        << process;
  }
}

TEST(Processes, LeaveWhatAConfigurationSaysOfItsUnits) {
  JobOptions options;
  options.config = "sgrt-balanced";
  const double flops = load_run_config(options).energy.flops.at("srp").nominal;
  options.sets = {"process=5nm"};
  EXPECT_EQ(load_run_config(options).energy.flops.at("srp").nominal, flops);
}

TEST(Processes, MixedWarnOnce) {
  for (const char* table : {"area.extends=7nm", "energy.extends=5nm", "power.extends=28nm"}) {
    const std::vector<std::string> lines = process_warnings(of_process("14nm", {table}));
    ASSERT_EQ(lines.size(), 1U) << table;
    EXPECT_NE(lines.front().find("results mix processes"), std::string::npos) << lines.front();
  }
  EXPECT_TRUE(process_warnings(of_process("14nm", {"latency.extends=7nm"})).empty()) << "no cache uses it";
  EXPECT_EQ(process_warnings(of_process("14nm", {"latency.extends=7nm", "l2.hit_cycles=auto"})).size(), 1U);
}

TEST(Processes, AVoltageThatTheProcessDoesNotAllowIsAWarning) {
  const auto warnings_at = [](const std::string& clock) {
    std::string all;
    for (const std::string& line :
         technology_table_warnings(of_process("7nm", {"power.voltage=dvfs", "clocks.tni=" + clock}))) {
      all += line;
    }
    return all;
  };
  EXPECT_EQ(warnings_at("800 MHz"), "");
  EXPECT_NE(warnings_at("1.2 GHz").find("power.max_voltage: clocks.tni of 1200 MHz needs"), std::string::npos);
  EXPECT_EQ(warnings_at("1.5 GHz").find("is outside"), std::string::npos);
  EXPECT_NE(warnings_at("1.6 GHz").find("is outside 77 MHz to 1500 MHz"), std::string::npos) << warnings_at("1.6 GHz");
}

// Tests that each value outside a table causes a warning, on random machines at the ends of their keys' ranges.

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
