#include "tools/analysis/top_down.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/build/tree_builder.h"
#include "hw_models/dram/dram_channel.h"
#include "hw_models/frame/dma.h"
#include "hw_models/frame/memory_interface.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/raster/raster_unit.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "sim/io/json.h"
#include "tools/analysis/units.h"

namespace tools {
namespace {

using sim::UnitReport;
using Trvs = Units<hw::Trv>;
using Ists = Units<hw::Ist>;
using L2Stats = hw::L2Bank::Stats;
using TrvStats = hw::Trv::Stats;
using SrpStats = hw::Srp::Stats;
using OfTrv = hw::Trv::CycleReason;
using OfIst = hw::Ist::CycleReason;
using OfSrp = hw::Srp::CycleReason;

using OfRaster = hw::RasterUnit::CycleReason;

double safe_ratio(auto a, auto b) { return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b); }

/// Mean latencies of L2 and memory in ns, and causes of queues in the L2.
struct MemoryLatencies {
  double l2 = 0;            ///< time from the arrival of a read at the L2 to the departure of its line
  double dram = 0;          ///< part of the L2's read latency that waits for memory
  double blocked_bank = 0;  ///< part of the L2's read latency that waits for an MSHR or for room on the way to memory
  double port_blocked = 0;  ///< share of the queues in front of the L2 that wait for an MSHR or for memory, 0 to 1
  double wires = 0;         ///< latency of a request and its line between core and L2, without queues
  double ideal_wires = 0;   ///< latency of a request and its line with an ideal interconnect, without queues
};

/// Returns the latency between a core and the L2 without queues, in L2 cycles: one cycle in the port, the distance in
/// both directions, and the cycles to transfer the line.
double wire_cycles(std::uint32_t distance, std::uint32_t line) { return 1.0 + 2.0 * distance + line; }

MemoryLatencies memory_latencies(std::span<const UnitReport> units, const hw::GpuConfig& config) {
  using OfBank = hw::L2Bank::CycleReason;
  // Chosen: if L2 banks are blocked for this share of time or more, all queues at ports are charged to the L2.
  constexpr double kOftenBlocked = 0.05;
  const Units<hw::L2Bank> banks(units);
  const double ns = 1000 / banks.clock_mhz();
  const std::uint64_t reads = banks.sum_of(&L2Stats::reads);
  MemoryLatencies b{.l2 = ns * safe_ratio(banks.sum_of(&L2Stats::latency), reads),
                    .dram = ns * safe_ratio(banks.sum_of(&L2Stats::memory_cycles), reads)};
  const double look_ups = ns * safe_ratio(banks.sum_of(&L2Stats::hits) * config.l2.cache.hit_cycles +
                                              banks.sum_of(&L2Stats::misses) * (config.l2.lookup_cycles + 1),
                                          reads);
  const double blocked = banks.share(OfBank::kMshrFull) + banks.share(OfBank::kMemoryFull);
  const double moving = banks.share(OfBank::kServing) + banks.share(OfBank::kOutputFull);
  b.blocked_bank = std::max(0.0, b.l2 - b.dram - look_ups) * safe_ratio(blocked, blocked + moving);
  b.port_blocked = std::min(1.0, blocked / kOftenBlocked);
  b.wires = ns * wire_cycles(config.interconnect.latency, config.interconnect.cycles_of(hw::kLineBytes));
  b.ideal_wires = ns * wire_cycles(1, 1);
  return b;
}

/// Splits the mean latency of a cache miss by memory level; all times in ns. `crossing`: time for lookups and clock
/// crossings; `line_wait`: time in queues for the wires from L2 to core. Both are parts of `latency`.
MissLevels split_miss(double latency, const MemoryLatencies& b, double crossing, double line_wait) {
  if (latency == 0) return {};
  const double dram = std::min(b.dram, latency), l2 = std::clamp(b.l2 - b.dram, 0.0, latency - dram);
  const double interconnect = latency - dram - l2;
  // time in queues between core and L2, except those for the wires from L2 to core
  const double queues = std::max(0.0, interconnect - b.wires - crossing - line_wait);
  const double wires = std::min(interconnect - queues, b.wires - b.ideal_wires + line_wait);
  return {.interconnect = interconnect / latency,
          .l2 = l2 / latency,
          .dram = dram / latency,
          .wires = (wires + queues * (1 - b.port_blocked)) / latency,
          .blocked_request = queues * b.port_blocked / latency,
          .blocked_bank = std::min(b.blocked_bank, l2) / latency};
}

/// Activity of the rays inside a T&I unit, as shares of the time in which a traversal unit (TRV) holds rays.
struct TniActivity {
  double boxes = 0, triangles = 0, misses = 0;
};

template <class Unit>
double misses_of(const Units<Unit>& units) {
  using Reason = typename Unit::CycleReason;
  return units.share(Reason::kL1Miss) + units.share(Reason::kMshrFull) + units.share(Reason::kRauFull);
}

TniActivity tni_activity(const Trvs& trvs, const Ists& ist) {
  const double there = 1 - trvs.share(OfTrv::kStarved), leaves = 1 - ist.share(OfIst::kStarved);
  const double at_ist = safe_ratio(trvs.share(OfTrv::kIst), there);
  return {safe_ratio(trvs.share(OfTrv::kVisiting) + trvs.share(OfTrv::kSerial), there),
          at_ist * safe_ratio(ist.share(OfIst::kTesting), leaves),
          safe_ratio(misses_of(trvs), there) + at_ist * safe_ratio(misses_of(ist), leaves)};
}

/// Returns the mean number of misses in flight: the sum of their latencies divided by the elapsed time.
template <class Unit>
double mean_misses_in_flight(const Units<Unit>& units) {
  return safe_ratio(units.sum_of(&Unit::Stats::l1_miss_cycles), units.elapsed());
}

/// Returns the mean number of rays that wait for a cache line; several may wait for the same line.
template <class Unit>
double rays_waiting(const Units<Unit>& units) {
  return mean_misses_in_flight(units) *
         safe_ratio(units.sum_of(&Unit::Stats::l1_late), units.sum_of(&Unit::Stats::l1_fills));
}

/// Sets a core's demands on memory: traffic shares of the DMA and of spilled ray slots, DRAM utilisation and queues.
void add_traffic(std::span<const UnitReport> units, std::uint32_t core, const hw::GpuConfig& config,
                 const MemoryLatencies& memory, CoreTime::Demands& d) {
  using Stats = hw::Dma::Stats;
  constexpr auto kSpill = static_cast<std::size_t>(hw::Area::kSpill);
  const Units<hw::Dma> all(units), dma(units, hw::unit_name_in_core(hw::Dma::kName, core));
  const Units<hw::CorePort> port(units, hw::unit_name_in_core(hw::CorePort::kDmaPort, core));
  const Units<hw::DramChannel> channels(units);
  const Units<hw::L2Bank> banks(units);
  const auto lines = [](const Units<hw::Dma>& of) {
    return of.sum_of(&Stats::lines_written) + of.sum_of(&Stats::lines_read);
  };
  const auto spilled = [](const Units<hw::Dma>& of) {
    return of.sum_of([](const Stats& s) -> const std::uint64_t& { return s.lines[kSpill].written; }) +
           of.sum_of([](const Stats& s) -> const std::uint64_t& { return s.lines[kSpill].read; });
  };
  const std::uint64_t memory_lines =
      channels.sum_of(&hw::DramChannel::Stats::reads) + channels.sum_of(&hw::DramChannel::Stats::writes);
  d.transfers = safe_ratio(lines(all), memory_lines);
  d.spills = safe_ratio(spilled(all), memory_lines);
  d.spilling = dma.empty() ? 0 : (1 - dma.share(hw::Dma::CycleReason::kIdle)) * safe_ratio(spilled(dma), lines(dma));
  d.spill_lines = safe_ratio(spilled(dma) * config.interconnect.cycles_of(hw::kLineBytes), port.elapsed());
  d.dram_bus = data_bus_share(units);
  d.dram_busy = channels.empty()
                    ? 0
                    : 1 - channels.share(hw::DramCycleReason::kIdle) - channels.share(hw::DramCycleReason::kLatency);
  const hw::DramTiming& timing = config.dram.timing;
  const double idle_ns = static_cast<double>(config.dram.fabric.time + timing.ck.time * (timing.rcd + timing.rl)) /
                         static_cast<double>(sim::kFemtosecondsPerSecond / 1'000'000'000);
  const double line_ns = memory.dram * safe_ratio(banks.sum_of(&L2Stats::reads), banks.sum_of(&L2Stats::misses));
  d.dram_queue = line_ns > idle_ns ? 1 - idle_ns / line_ns : 0;
}

double record_share(std::span<const UnitReport> units, const Units<hw::L2Bank>& banks) {
  using Stats = hw::MemoryInterface::Stats;
  const Units<hw::MemoryInterface> records(units);
  std::uint64_t requests = 0;
  for (const auto kind : {&Stats::ray_reads, &Stats::ray_writes, &Stats::hit_reads, &Stats::hit_writes})
    requests += records.sum_of(kind);
  return safe_ratio(requests, banks.sum_of(&L2Stats::reads) + banks.sum_of(&L2Stats::writes));
}

/// Returns the time that all node visits would take at the rate reached while every ray slot was in use. If that was
/// rarely the case, the mean rate of the whole run is used instead.
double tracing_demand(const Trvs& trvs) {
  const double occupied = 1 - trvs.share(OfTrv::kStarved),
               full = safe_ratio(trvs.sum_of(&TrvStats::full), trvs.elapsed());
  if (full < 0.02) return occupied;
  return std::min(occupied, full * safe_ratio(trvs.sum_of(&TrvStats::visits), trvs.sum_of(&TrvStats::full_visits)));
}

/// Moves time without rays from a core's `transfers` to its rasteriser, up to the rasteriser's busy time. An
/// approximation: in this time launches mostly wait for the rasteriser.
void charge_raster_time(const Units<hw::RasterUnit>& rasteriser, const MemoryLatencies& memory, CoreTime& t) {
  const double busy = rasteriser.empty() ? 0 : 1 - rasteriser.share(OfRaster::kIdle);
  if (busy == 0) return;
  const double misses = rasteriser.share(OfRaster::kMemory) + rasteriser.share(OfRaster::kPortFull);
  const double awaited = std::min(t.transfers, busy);
  t.transfers -= awaited;
  t.raster_misses = awaited * misses / busy;
  t.raster = awaited - t.raster_misses;
  t.raster_levels = split_miss(memory.l2, memory, 0, 0);
}

/// Moves time without a tile to the tree builder, up to the builder's busy time. An approximation: tiles mostly wait
/// for trees in this time.
void charge_build_time(const Units<hw::TreeBuilder>& builder, const MemoryLatencies& memory, CoreTime& t) {
  using Reason = hw::TreeBuilder::CycleReason;
  const double busy = builder.empty() ? 0 : 1 - builder.share(Reason::kIdle);
  if (busy == 0) return;
  const double awaited = std::min(t.no_tile, busy);
  t.no_tile -= awaited;
  t.build_misses = awaited * (builder.share(Reason::kMemory) + builder.share(Reason::kPortFull)) / busy;
  t.build = awaited - t.build_misses;
  t.build_levels = split_miss(memory.l2, memory, 0, 0);
}

CoreTime core_time(std::span<const UnitReport> units, std::uint32_t number, const MemoryLatencies& memory,
                   const hw::GpuConfig& config) {
  constexpr double kIdealRays = 64;  // rays that wait for lines at once in an ideal traversal unit (hw::IdealConfig)
  const std::string core = hw::unit_name_in_core("core.", number);
  const Units<hw::Srp> srp(units, core);
  const Trvs trvs(units, core);
  const Ists ist(units, core);
  const Units<hw::L2Bank> banks(units);
  CoreTime t;
  t.kernels = srp.share(OfSrp::kRunning);
  t.switches = srp.share(OfSrp::kSwitching);
  t.banks = srp.share(OfSrp::kBanks);
  t.data_misses = srp.share(OfSrp::kCacheMiss);
  t.no_tile = srp.share(OfSrp::kStarved);
  const Units<hw::CorePort> port(units, hw::unit_name_in_core(hw::CorePort::kCachePort, number));
  using PortStats = hw::CorePort::Stats;
  t.demands = {
      .no_slots = srp.share(OfSrp::kNoSlots),
      .fed = safe_ratio(srp.sum_of(&SrpStats::fed), srp.elapsed()),
      .occupied = 1 - trvs.share(OfTrv::kStarved),
      .tree_lines = std::max(mean_misses_in_flight(trvs) / config.tni.trv.l1.mshrs,
                             mean_misses_in_flight(ist) / config.tni.ist.l1.mshrs),
      .tree_waits = std::max(rays_waiting(trvs), rays_waiting(ist)) / kIdealRays,
      .tests = std::max(trvs.share(OfTrv::kVisiting) + trvs.share(OfTrv::kSerial), ist.share(OfIst::kTesting)),
      .data_lines = safe_ratio(srp.sum_of(&SrpStats::cache_miss_cycles), srp.elapsed()) / config.srp.data_cache.mshrs,
      .l2_lines = safe_ratio(banks.sum_of(&L2Stats::line_cycles), banks.elapsed()) / config.l2.mshrs_per_bank(),
      .port_lines = safe_ratio(port.sum_of(&PortStats::lines_down) * config.interconnect.cycles_of(hw::kLineBytes),
                               port.elapsed()),
      .tracing = tracing_demand(trvs),
      .records = record_share(units, banks)};
  add_traffic(units, number, config, memory, t.demands);
  const double tracing = safe_ratio(srp.sum_of(&SrpStats::awaited), srp.elapsed());
  t.transfers = std::max(0.0, srp.share(OfSrp::kWaiting) + srp.share(OfSrp::kBorders) + t.demands.no_slots - tracing);
  charge_raster_time(Units<hw::RasterUnit>(units, core), memory, t);
  charge_build_time(Units<hw::TreeBuilder>(units), memory, t);
  const TniActivity in = tni_activity(trvs, ist);
  t.boxes = tracing * in.boxes;
  t.triangles = tracing * in.triangles;
  t.tree_misses = tracing * in.misses;
  t.pipes = tracing - t.boxes - t.triangles - t.tree_misses;
  const double srp_ns = 1000 / srp.clock_mhz(), tni_ns = 1000 / trvs.clock_mhz(), l2_ns = 1000 / banks.clock_mhz();
  const double line_wait = l2_ns * safe_ratio(port.sum_of(&PortStats::line_wait), port.sum_of(&PortStats::lines_down));
  // Returns the ns of a lookup with cycle time `ns`, plus synchronisers in both directions if the L2 has another clock.
  const auto crossing = [&](double ns) { return ns + (ns == l2_ns ? 0 : config.clocks.synchroniser * (ns + l2_ns)); };
  t.data_levels =
      split_miss(srp_ns * safe_ratio(srp.sum_of(&SrpStats::cache_miss_cycles), srp.sum_of(&SrpStats::cache_fills)),
                 memory, crossing(srp_ns), line_wait);
  t.tree_levels = split_miss(
      tni_ns * safe_ratio(trvs.sum_of(&TrvStats::l1_miss_cycles) + ist.sum_of(&hw::Ist::Stats::l1_miss_cycles),
                          trvs.sum_of(&TrvStats::l1_fills) + ist.sum_of(&hw::Ist::Stats::l1_fills)),
      memory, crossing(tni_ns), line_wait);
  return t;
}

/// A cause in the breakdown of a core's time: name in reports, description, share and, for misses, memory levels.
struct TimePart {
  std::string_view name;
  const char* words;
  double CoreTime::*share;
  MissLevels CoreTime::*levels = nullptr;
  bool is_optional = false;  ///< reported only if it is not 0
};
constexpr std::array<TimePart, 14> kParts = {
    {{"kernels", "kernels", &CoreTime::kernels},
     {"switches", "kernel switches", &CoreTime::switches},
     {"banks", "tile-buffer banks", &CoreTime::banks},
     {"data_misses", "data-cache misses", &CoreTime::data_misses, &CoreTime::data_levels},
     {"boxes", "box tests", &CoreTime::boxes},
     {"triangles", "triangle tests", &CoreTime::triangles},
     {"pipes", "T&I pipelines", &CoreTime::pipes},
     {"tree_misses", "tree misses", &CoreTime::tree_misses, &CoreTime::tree_levels},
     {"raster", "rasteriser", &CoreTime::raster},
     {"raster_misses", "rasteriser's misses", &CoreTime::raster_misses, &CoreTime::raster_levels},
     {"build", "tree builder", &CoreTime::build, nullptr, true},
     {"build_misses", "tree builder's misses", &CoreTime::build_misses, &CoreTime::build_levels, true},
     {"transfers", "transfers", &CoreTime::transfers},
     {"no_tile", "no tile", &CoreTime::no_tile}}};

using Demands = CoreTime::Demands;
constexpr std::array<std::pair<const char*, double Demands::*>, 18> kDemands = {{{"no_slots", &Demands::no_slots},
                                                                                 {"fed", &Demands::fed},
                                                                                 {"occupied", &Demands::occupied},
                                                                                 {"tree_lines", &Demands::tree_lines},
                                                                                 {"tree_waits", &Demands::tree_waits},
                                                                                 {"tests", &Demands::tests},
                                                                                 {"data_lines", &Demands::data_lines},
                                                                                 {"l2_lines", &Demands::l2_lines},
                                                                                 {"port_lines", &Demands::port_lines},
                                                                                 {"dram_bus", &Demands::dram_bus},
                                                                                 {"dram_busy", &Demands::dram_busy},
                                                                                 {"dram_queue", &Demands::dram_queue},
                                                                                 {"transfers", &Demands::transfers},
                                                                                 {"spills", &Demands::spills},
                                                                                 {"spilling", &Demands::spilling},
                                                                                 {"spill_lines", &Demands::spill_lines},
                                                                                 {"tracing", &Demands::tracing},
                                                                                 {"records", &Demands::records}}};

/// Adds a core's split of miss latency by level to `all`, weighted by the core's miss time.
void add_levels(MissLevels& all, const MissLevels& core, double weight) {
  for (double MissLevels::*level : {&MissLevels::interconnect, &MissLevels::l2, &MissLevels::dram, &MissLevels::wires,
                                    &MissLevels::blocked_request, &MissLevels::blocked_bank}) {
    all.*level += core.*level * weight;
  }
}

sim::Json levels_json(const MissLevels& l, double share) {
  return {{"interconnect", share * l.interconnect}, {"l2", share * l.l2}, {"dram", share * l.dram}};
}

/// Returns a share of time from JSON: the number itself, or the sum over memory levels.
double sum_of_levels(const sim::Json& share) {
  double all = 0;
  for (const sim::Json& part : share) all += part.get<double>();
  return all;
}

}  // namespace

double data_bus_share(std::span<const UnitReport> units) {
  const Units<hw::DramChannel> channels(units);
  return channels.share(hw::DramCycleReason::kReading) + channels.share(hw::DramCycleReason::kWriting);
}

TopDown top_down(std::span<const UnitReport> units, const hw::GpuConfig& config) {
  const MemoryLatencies memory = memory_latencies(units, config);
  TopDown view;
  for (std::uint32_t c = 0; !Units<hw::Srp>(units, hw::unit_name_in_core(hw::Srp::kName, c)).empty(); ++c) {
    view.cores.push_back(core_time(units, c, memory, config));
  }
  const auto cores = static_cast<double>(view.cores.size());
  CoreTime& gpu = view.gpu;
  for (const CoreTime& core : view.cores) {
    for (const TimePart& part : kParts) gpu.*part.share += core.*part.share / cores;
    for (const auto& [name, demand] : kDemands) gpu.demands.*demand += core.demands.*demand / cores;
  }
  for (const CoreTime& core : view.cores) {
    for (const TimePart& part : kParts) {
      if (part.levels == nullptr || gpu.*part.share <= 0) continue;
      add_levels(gpu.*part.levels, core.*part.levels, core.*part.share / (cores * gpu.*part.share));
    }
  }
  return view;
}

sim::Json time_json(const CoreTime& t) {
  sim::Json out = sim::Json::object();
  for (const TimePart& part : kParts) {
    if (part.is_optional && t.*part.share == 0) continue;
    out[part.name] = part.levels == nullptr ? sim::Json(t.*part.share) : levels_json(t.*part.levels, t.*part.share);
  }
  for (const auto& [name, demand] : kDemands) out["demands"][name] = t.demands.*demand;
  return out;
}

std::string describe_time_part(const std::string& path) {
  constexpr std::array<std::pair<std::string_view, const char*>, 3> kLevels = {
      {{"dram", "DRAM"}, {"l2", "L2"}, {"interconnect", "interconnect"}}};
  const std::size_t dot = path.find('.');
  if (dot != std::string::npos)
    return describe_time_part(path.substr(0, dot)) + ": " + describe_time_part(path.substr(dot + 1));
  for (const TimePart& part : kParts) {
    if (part.name == path) return part.words;
  }
  for (const auto& [level, words] : kLevels) {
    if (level == path) return words;
  }
  return path;
}

sim::Json top_down_json(const TopDown& view) {
  sim::Json out = {{"gpu", time_json(view.gpu)}, {"cores", sim::Json::array()}};
  for (const CoreTime& core : view.cores) out["cores"].push_back(time_json(core));
  return out;
}

std::string top_down_text(const sim::Json& time) {
  std::vector<std::pair<double, std::string>> parts;
  for (const auto& [name, share] : time.items()) {
    if (name == "demands") continue;
    const double all = sum_of_levels(share);
    if (all < 0.005) continue;
    const std::string inner = share.is_object() ? top_down_text(share) : "";
    parts.emplace_back(all, fmt::format("{} {:.0f} %{}", describe_time_part(name), 100 * all,
                                        inner.empty() ? "" : fmt::format(" ({})", inner)));
  }
  std::ranges::stable_sort(parts, std::greater<>(), &std::pair<double, std::string>::first);
  std::vector<std::string> words;
  for (auto& [share, word] : parts) words.push_back(std::move(word));
  return fmt::format("{}", fmt::join(words, ", "));
}

GrownPart most_grown_part(const TimeInCycles& before, const TimeInCycles& after) {
  GrownPart most;
  for (const auto& [name, share] : before.time.items()) {
    if (name == "demands") continue;
    const double later = after.time.contains(name) ? sum_of_levels(after.time.at(name)) : 0;
    const double more = after.cycles * later - before.cycles * sum_of_levels(share);
    if (more > most.cycles) most = {describe_time_part(name), more};
  }
  return most;
}

namespace {

// The constants below are fitted to 39 random machines that are not in the tables of docs/bottleneck.md.

/// Mean share of a cache's MSHRs that are in use while misses alone limit the cache.
constexpr double kMshrsInUse = 2.0 / 3;
/// Largest share of time in which a DRAM data bus can transfer data.
constexpr double kBusAtBest = 0.9;
/// Of the time in which a DRAM channel is busy without data, such as row commands, the share that other requests cannot
/// hide.
constexpr double kBusyWeight = 1.0 / 3;
/// Largest share of time in which the wires of a port can be in use, because requests come in bursts.
constexpr double kPortAtBest = 0.7;
/// Largest share of cycles in which a T&I unit can do tests, because rays come in bursts.
constexpr double kTestsAtBest = 0.85;
/// Fraction of the ideal gain from more ray slots that is realised.
constexpr double kSlotsGain = 0.6;
constexpr double kEndsOfTiles = 0.35, kSlotsWeight = 5;  // fitted parameters of remaining_free_slot_share()

/// Times that three stages of a core would need if each worked alone: shader core, T&I unit, and DMA including the
/// transfers of spilled ray slots.
using Stages = std::array<double, 3>;

/// Returns a core's time if its stages overlap with the exponent `p` of estimate_speedups().
double combined_time(const Stages& stages, double p) {
  const double longest = std::ranges::max(stages);
  if (longest <= 0) return 0;
  double sum = 0;
  for (const double stage : stages) sum += std::pow(std::max(stage, 0.0) / longest, p);
  return longest * std::pow(sum, 1 / p);
}

/// Returns the overlap exponent p for which combined_time(stages, p) = time.
double overlap_exponent(const Stages& stages, double time) {
  if (combined_time(stages, 1) <= time) return 1;
  double low = 1, high = 40;
  for (int i = 0; i < 60; ++i) {
    const double p = (low + high) / 2;
    (combined_time(stages, p) > time ? low : high) = p;
  }
  return low;
}

/// Returns which fraction of the T&I unit's time with free ray slots would remain with ideal shader cores. The time at
/// the ends of tiles always remains. The fraction grows with the time for which launches wait for ray slots of the tile
/// buffer.
double remaining_free_slot_share(const CoreTime::Demands& d) {
  if (d.fed <= 0) return 1;
  return std::min(1.0, kEndsOfTiles + kSlotsWeight * d.no_slots * (1 - d.tracing / d.fed));
}

/// Returns the queue length of a memory after the fraction `gone` of its traffic is removed, relative to the length
/// before. Queue length is r / (1 - r) at utilisation r.
double remaining_queue_ratio(double busy, double gone) {
  constexpr double kMostBusy = 0.95;  // limits the queue length, which is finite in a finite frame
  if (busy <= 0) return 1;
  const double r = std::min(busy, kMostBusy), left = r * (1 - gone);
  return left / (1 - left) / (r / (1 - r));
}

/// Lower bounds of the frame time. Each is the time of one resource's work if all other resources are ideal.
struct LowerBounds {
  double memory = 0, lines = 0, wires = 0, tests = 0;
};
LowerBounds lower_time_bounds(const CoreTime::Demands& d) {
  return {.memory = (1 - kBusyWeight) * d.dram_bus / kBusAtBest + kBusyWeight * d.dram_busy,
          .lines = 2 * d.l2_lines / (1 + d.l2_lines),  // chosen: misses could use half of the free MSHRs, too
          .wires = d.port_lines / kPortAtBest,
          .tests = d.tests / kTestsAtBest};
}

/// Returns the times of a core's stages if no ray slots were spilled: memory queues are shorter and the L2 is blocked
/// less. `tree`: miss time of the T&I unit.
Stages stages_without_spills(const CoreTime& t, double tree) {
  const double relief = t.demands.dram_queue * (1 - remaining_queue_ratio(t.demands.dram_busy, t.demands.spills));
  const auto saved = [&](const MissLevels& m) { return relief * (m.dram + m.blocked_share()); };
  return {t.busy_share() + t.data_misses * (1 - saved(t.data_levels)), t.demands.fed - tree * saved(t.tree_levels), 0};
}

std::string_view resource_words(std::string_view resource) {
  return std::ranges::find(hw::IdealConfig::kResources, resource, &hw::IdealConfig::Resource::name)->words;
}

}  // namespace

Utilisation utilisation_of(std::span<const sim::UnitReport> units) {
  using Reason = hw::Srp::CycleReason;
  const Units<hw::Srp> srps(units);
  return {Units<hw::Trv>(units).share(hw::Trv::CycleReason::kVisiting),
          srps.share(Reason::kRunning) + srps.share(Reason::kSwitching), data_bus_share(units)};
}

std::vector<Estimate> estimate_speedups(const CoreTime& t) {
  const CoreTime::Demands& d = t.demands;
  const double time = 1 - (t.raster + t.raster_misses + t.transfers + t.no_tile);
  const double kernels = t.busy_share(), shading = kernels + t.data_misses;
  const double spilling = std::min(d.spilling, time);
  const double p = overlap_exponent({shading, d.fed, spilling}, time);
  const double tree =
      t.tracing_share() > 0 ? d.fed * t.tree_misses / t.tracing_share() : 0;  // miss time of the T&I unit
  const double ideal_tree = std::max(std::min(d.fed, d.tree_lines / kMshrsInUse), std::min(tree, d.tree_waits));
  const double ideal_data = std::min(t.data_misses, d.data_lines / kMshrsInUse);
  const double full_tracing = d.tracing + (d.fed - d.tracing) * remaining_free_slot_share(d);

  const LowerBounds least = lower_time_bounds(d);
  const double moved = least.memory * d.transfers;  // DMA traffic bypasses the caches and the L2
  const double all = std::max({least.memory, least.lines, least.wires});

  // `part` returns a share of a miss latency. The two functions return times without this share: without() that of the
  // combined stages, raster_without() that of the rasteriser's misses.
  using Part = double (*)(const MissLevels&);
  const auto without = [&](Part part, double spills) {
    return combined_time(
        {kernels + t.data_misses * (1 - part(t.data_levels)), d.fed - tree * part(t.tree_levels), spills}, p);
  };
  const auto raster_without = [&](Part part) { return t.raster_misses * (1 - part(t.raster_levels)); };
  const Part everything = [](const MissLevels&) { return 1.0; };
  const Part of_l2 = [](const MissLevels& m) { return m.l2 + m.dram + m.blocked_request; };
  const Part of_dram = [](const MissLevels& m) { return m.dram + m.blocked_share(); };
  const Part of_wires = [](const MissLevels& m) { return m.wires; };

  const double moving = std::min(spilling, d.spill_lines);  // time to move spilled slots with an ideal memory

  const Stages fitting = stages_without_spills(t, tree);
  const double fitting_time = combined_time(fitting, p);
  const double hidden = std::clamp(fitting_time - std::ranges::max(fitting), 0.0, d.no_slots + t.banks);

  struct Rest {
    const char* resource;
    double stages, transfers, raster_misses;
    double least_time;  ///< lower bound of the frame time, as a share of the measured time
  };
  const std::vector<Rest> rests = {
      {"tni", combined_time({shading, ideal_tree, spilling}, p), t.transfers, t.raster_misses, all},
      {"l1", without(everything, spilling), t.transfers, 0, std::max({all * d.records, moved, least.tests})},
      {"l2", without(of_l2, spilling), t.transfers, raster_without(of_l2), std::max({moved, least.wires, least.tests})},
      {"dram", without(of_dram, moving), spilling > 0 ? t.transfers * moving / spilling : 0, raster_without(of_dram),
       std::max(least.wires, least.tests)},
      {"srp", combined_time({ideal_data, full_tracing, spilling}, p), t.transfers, t.raster_misses, all},
      {"tile_buffer", fitting_time - kSlotsGain * hidden, 0, t.raster_misses,
       std::max((1 - d.spills) * std::max(least.memory, least.lines), least.wires)},
      {"interconnect", without(of_wires, spilling), t.transfers, raster_without(of_wires),
       std::max(least.memory, least.lines)},
  };
  std::vector<Estimate> estimates;
  for (const Rest& rest : rests) {
    // The time in which a core waits for the last tiles of other cores scales with the time per tile.
    const double busy = std::min(rest.stages, time) + rest.transfers + t.raster + rest.raster_misses;
    const double total = t.no_tile < 1 ? std::max(busy / (1 - t.no_tile), rest.least_time) : 1;
    estimates.push_back({rest.resource, total > 0 && total < 1 ? 1 / total : 1});
  }
  return estimates;
}

const Estimate& largest_speedup(const std::vector<Estimate>& estimates) {
  return *std::ranges::max_element(estimates, {}, &Estimate::speedup);
}

std::string limiter_text(std::vector<Estimate> estimates) {
  std::ranges::stable_sort(estimates, std::greater<>(), &Estimate::speedup);
  const Estimate &first = estimates[0], &second = estimates[1];
  if (first.speedup < 1.01) return "no single resource: none would gain 1 % if ideal";
  return fmt::format("{} (x{:.2f} if ideal; next: {}, x{:.2f})", resource_words(first.resource), first.speedup,
                     resource_words(second.resource), second.speedup);
}

}  // namespace tools
