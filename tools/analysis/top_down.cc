#include "tools/analysis/top_down.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  double l2 = 0;            ///< from the arrival of a read to the departure of its line
  double dram = 0;          ///< part of `l2` that waits for memory
  double blocked_bank = 0;  ///< part of `l2` that waits for an MSHR or for room on the way to memory
  double port_blocked = 0;  ///< share of the queues before the L2 with that cause, 0 to 1
  double wires = 0;         ///< latency of a request and its line between core and L2, without queues
  double ideal_wires = 0;   ///< the same with an ideal interconnect
};

/// Latency between a core and the L2 without queues, in L2 cycles: one in the port, the distance both ways, the line on
/// the wires.
double wire_cycles(std::uint32_t distance, std::uint32_t line) { return 1.0 + 2.0 * distance + line; }

MemoryLatencies memory_latencies(std::span<const UnitReport> units, const hw::GpuConfig& config) {
  using OfBank = hw::L2Bank::CycleReason;
  constexpr double kOftenBlocked = 0.05;  // chosen: below this share of time, queues arise in the ports themselves
  const Units<hw::L2Bank> banks(units);
  const double ns = 1000 / banks.clock_mhz();
  const std::uint64_t reads = banks.counted(&L2Stats::reads);
  MemoryLatencies b{.l2 = ns * safe_ratio(banks.counted(&L2Stats::latency), reads),
                    .dram = ns * safe_ratio(banks.counted(&L2Stats::memory_cycles), reads)};
  const double look_ups = ns * safe_ratio(banks.counted(&L2Stats::hits) * config.l2.cache.hit_cycles +
                                              banks.counted(&L2Stats::misses) * (config.l2.lookup_cycles + 1),
                                          reads);
  const double blocked = banks.share(OfBank::kMshrFull) + banks.share(OfBank::kMemoryFull);
  const double moving = banks.share(OfBank::kServing) + banks.share(OfBank::kOutputFull);
  b.blocked_bank = std::max(0.0, b.l2 - b.dram - look_ups) * safe_ratio(blocked, blocked + moving);
  b.port_blocked = std::min(1.0, blocked / kOftenBlocked);
  b.wires = ns * wire_cycles(config.interconnect.latency, config.interconnect.cycles_of(hw::kLineBytes));
  b.ideal_wires = ns * wire_cycles(1, 1);
  return b;
}

/// Splits a miss latency by level; all times in ns. `crossing`: part of `latency` for lookup and clock crossings;
/// `line_wait`: part in queues for the wires down.
MissLevels split_miss(double latency, const MemoryLatencies& b, double crossing, double line_wait) {
  if (latency == 0) return {};
  const double dram = std::min(b.dram, latency), l2 = std::clamp(b.l2 - b.dram, 0.0, latency - dram);
  const double interconnect = latency - dram - l2;
  const double queues = std::max(0.0, interconnect - b.wires - crossing - line_wait);  // queues on the way up
  const double wires = std::min(interconnect - queues, b.wires - b.ideal_wires + line_wait);
  return {.interconnect = interconnect / latency,
          .l2 = l2 / latency,
          .dram = dram / latency,
          .wires = (wires + queues * (1 - b.port_blocked)) / latency,
          .blocked_request = queues * b.port_blocked / latency,
          .blocked_bank = std::min(b.blocked_bank, l2) / latency};
}

/// Activity of the rays inside a T&I unit, as shares of the time with rays in a TRV.
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

/// Returns the mean number of misses in flight: the sum of their latencies over elapsed time.
template <class Unit>
double misses_under_way(const Units<Unit>& units) {
  return safe_ratio(units.counted(&Unit::Stats::l1_miss_cycles), units.elapsed());
}

/// Returns the mean number of waiting rays; several may wait for one line.
template <class Unit>
double rays_waiting(const Units<Unit>& units) {
  return misses_under_way(units) *
         safe_ratio(units.counted(&Unit::Stats::l1_late), units.counted(&Unit::Stats::l1_fills));
}

/// Adds the shares of the DMA and of spilled ray slots in memory traffic.
void add_traffic(std::span<const UnitReport> units, std::uint32_t core, const hw::GpuConfig& config,
                 const MemoryLatencies& memory, CoreTime::Demands& d) {
  using Stats = hw::Dma::Stats;
  constexpr auto kSpill = static_cast<std::size_t>(hw::Area::kSpill);
  const Units<hw::Dma> all(units), dma(units, hw::name_in_core(hw::Dma::kName, core));
  const Units<hw::CorePort> port(units, hw::name_in_core(hw::CorePort::kDmaPort, core));
  const Units<hw::DramChannel> channels(units);
  const Units<hw::L2Bank> banks(units);
  const auto lines = [](const Units<hw::Dma>& of) {
    return of.counted(&Stats::lines_written) + of.counted(&Stats::lines_read);
  };
  const auto spilled = [](const Units<hw::Dma>& of) {
    return of.counted([](const Stats& s) -> const std::uint64_t& { return s.lines[kSpill].written; }) +
           of.counted([](const Stats& s) -> const std::uint64_t& { return s.lines[kSpill].read; });
  };
  const std::uint64_t memory_lines =
      channels.counted(&hw::DramChannel::Stats::reads) + channels.counted(&hw::DramChannel::Stats::writes);
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
  const double line_ns = memory.dram * safe_ratio(banks.counted(&L2Stats::reads), banks.counted(&L2Stats::misses));
  d.dram_queue = line_ns > idle_ns ? 1 - idle_ns / line_ns : 0;
}

double record_share(std::span<const UnitReport> units, const Units<hw::L2Bank>& banks) {
  using Stats = hw::MemoryInterface::Stats;
  const Units<hw::MemoryInterface> records(units);
  std::uint64_t requests = 0;
  for (const auto kind : {&Stats::ray_reads, &Stats::ray_writes, &Stats::hit_reads, &Stats::hit_writes})
    requests += records.counted(kind);
  return safe_ratio(requests, banks.counted(&L2Stats::reads) + banks.counted(&L2Stats::writes));
}

/// Returns the time of all visits at the rate while every ray slot was taken; at the overall rate if that was rare.
double tracing_demand(const Trvs& trvs) {
  const double occupied = 1 - trvs.share(OfTrv::kStarved),
               full = safe_ratio(trvs.counted(&TrvStats::full), trvs.elapsed());
  if (full < 0.02) return occupied;
  return std::min(occupied, full * safe_ratio(trvs.counted(&TrvStats::visits), trvs.counted(&TrvStats::full_visits)));
}

/// Moves time without rays to the rasteriser, up to its busy time, in proportion to its activity over the frame. An
/// approximation: launches mostly wait for the rasteriser then.
void part_from_transfers(const Units<hw::RasterUnit>& rasteriser, const MemoryLatencies& memory, CoreTime& t) {
  const double busy = rasteriser.empty() ? 0 : 1 - rasteriser.share(OfRaster::kIdle);
  if (busy == 0) return;
  const double misses = rasteriser.share(OfRaster::kMemory) + rasteriser.share(OfRaster::kPortFull);
  const double awaited = std::min(t.transfers, busy);
  t.transfers -= awaited;
  t.raster_misses = awaited * misses / busy;
  t.raster = awaited - t.raster_misses;
  t.raster_levels = split_miss(memory.l2, memory, 0, 0);
}

CoreTime core_time(std::span<const UnitReport> units, std::uint32_t number, const MemoryLatencies& memory,
                   const hw::GpuConfig& config) {
  constexpr double kIdealRays = 64;  // per TRV (hw::IdealConfig)
  const std::string core = hw::name_in_core("core.", number);
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
  const Units<hw::CorePort> port(units, hw::name_in_core(hw::CorePort::kCachePort, number));
  using PortStats = hw::CorePort::Stats;
  t.demands = {
      .no_slots = srp.share(OfSrp::kNoSlots),
      .fed = safe_ratio(srp.counted(&SrpStats::fed), srp.elapsed()),
      .occupied = 1 - trvs.share(OfTrv::kStarved),
      .tree_lines =
          std::max(misses_under_way(trvs) / config.tni.trv.l1.mshrs, misses_under_way(ist) / config.tni.ist.l1.mshrs),
      .tree_waits = std::max(rays_waiting(trvs), rays_waiting(ist)) / kIdealRays,
      .tests = std::max(trvs.share(OfTrv::kVisiting) + trvs.share(OfTrv::kSerial), ist.share(OfIst::kTesting)),
      .data_lines = safe_ratio(srp.counted(&SrpStats::cache_miss_cycles), srp.elapsed()) / config.srp.data_cache.mshrs,
      .l2_lines = safe_ratio(banks.counted(&L2Stats::line_cycles), banks.elapsed()) / config.l2.mshrs_per_bank(),
      .port_lines = safe_ratio(port.counted(&PortStats::lines_down) * config.interconnect.cycles_of(hw::kLineBytes),
                               port.elapsed()),
      .tracing = tracing_demand(trvs),
      .records = record_share(units, banks)};
  add_traffic(units, number, config, memory, t.demands);
  const double tracing = safe_ratio(srp.counted(&SrpStats::awaited), srp.elapsed());
  t.transfers = std::max(0.0, srp.share(OfSrp::kWaiting) + srp.share(OfSrp::kBorders) + t.demands.no_slots - tracing);
  part_from_transfers(Units<hw::RasterUnit>(units, core), memory, t);
  const TniActivity in = tni_activity(trvs, ist);
  t.boxes = tracing * in.boxes;
  t.triangles = tracing * in.triangles;
  t.tree_misses = tracing * in.misses;
  t.pipes = tracing - t.boxes - t.triangles - t.tree_misses;
  const double srp_ns = 1000 / srp.clock_mhz(), tni_ns = 1000 / trvs.clock_mhz(), l2_ns = 1000 / banks.clock_mhz();
  const double line_wait =
      l2_ns * safe_ratio(port.counted(&PortStats::line_wait), port.counted(&PortStats::lines_down));
  // ns: one cache cycle for the lookup, plus the synchronisers of both directions if the clocks differ.
  const auto crossing = [&](double ns) { return ns + (ns == l2_ns ? 0 : config.clocks.synchroniser * (ns + l2_ns)); };
  t.data_levels =
      split_miss(srp_ns * safe_ratio(srp.counted(&SrpStats::cache_miss_cycles), srp.counted(&SrpStats::cache_fills)),
                 memory, crossing(srp_ns), line_wait);
  t.tree_levels = split_miss(
      tni_ns * safe_ratio(trvs.counted(&TrvStats::l1_miss_cycles) + ist.counted(&hw::Ist::Stats::l1_miss_cycles),
                          trvs.counted(&TrvStats::l1_fills) + ist.counted(&hw::Ist::Stats::l1_fills)),
      memory, crossing(tni_ns), line_wait);
  return t;
}

/// Calls f(member of a, same member of b) for every share and demand.
template <class A, class F>
void each_share(A& a, const CoreTime& b, F&& f) {
  for (double CoreTime::*share :
       {&CoreTime::kernels, &CoreTime::switches, &CoreTime::banks, &CoreTime::data_misses, &CoreTime::boxes,
        &CoreTime::triangles, &CoreTime::pipes, &CoreTime::tree_misses, &CoreTime::raster, &CoreTime::raster_misses,
        &CoreTime::transfers, &CoreTime::no_tile}) {
    f(a.*share, b.*share);
  }
  using Demands = CoreTime::Demands;
  for (double Demands::*demand :
       {&Demands::no_slots, &Demands::fed, &Demands::occupied, &Demands::tree_lines, &Demands::tree_waits,
        &Demands::tests, &Demands::data_lines, &Demands::l2_lines, &Demands::port_lines, &Demands::dram_bus,
        &Demands::dram_busy, &Demands::dram_queue, &Demands::transfers, &Demands::spills, &Demands::spilling,
        &Demands::spill_lines, &Demands::tracing, &Demands::records}) {
    f(a.demands.*demand, b.demands.*demand);
  }
}

/// Miss time by kind of cache, and its levels.
constexpr std::array<std::pair<double CoreTime::*, MissLevels CoreTime::*>, 3> kMisses = {
    {{&CoreTime::data_misses, &CoreTime::data_levels},
     {&CoreTime::tree_misses, &CoreTime::tree_levels},
     {&CoreTime::raster_misses, &CoreTime::raster_levels}}};

/// Adds a core's miss levels, weighted by its miss time.
void add_levels(MissLevels& all, const MissLevels& core, double weight) {
  for (double MissLevels::*level : {&MissLevels::interconnect, &MissLevels::l2, &MissLevels::dram, &MissLevels::wires,
                                    &MissLevels::blocked_request, &MissLevels::blocked_bank}) {
    all.*level += core.*level * weight;
  }
}

sim::Json levels_json(const MissLevels& l, double share) {
  return {{"interconnect", share * l.interconnect}, {"l2", share * l.l2}, {"dram", share * l.dram}};
}

/// Returns the display name of a part or level.
const char* word_for(const std::string& name) {
  static const std::map<std::string, const char*> kWords = {{"kernels", "kernels"},
                                                            {"switches", "kernel switches"},
                                                            {"banks", "tile-buffer banks"},
                                                            {"data_misses", "data-cache misses"},
                                                            {"boxes", "box tests"},
                                                            {"triangles", "triangle tests"},
                                                            {"pipes", "T&I pipelines"},
                                                            {"tree_misses", "tree misses"},
                                                            {"raster", "rasteriser"},
                                                            {"raster_misses", "rasteriser's misses"},
                                                            {"transfers", "transfers"},
                                                            {"no_tile", "no tile"},
                                                            {"dram", "DRAM"},
                                                            {"l2", "L2"},
                                                            {"interconnect", "interconnect"}};
  return kWords.at(name);
}

/// Returns a share, or the sum of its levels.
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
  for (std::uint32_t c = 0; !Units<hw::Srp>(units, hw::name_in_core(hw::Srp::kName, c)).empty(); ++c) {
    view.cores.push_back(core_time(units, c, memory, config));
  }
  const auto cores = static_cast<double>(view.cores.size());
  CoreTime& gpu = view.gpu;
  for (const CoreTime& core : view.cores) {
    each_share(gpu, core, [&](double& sum, double share) { sum += share / cores; });
  }
  for (const CoreTime& core : view.cores) {
    for (const auto& [misses, of_levels] : kMisses) {
      if (gpu.*misses > 0) add_levels(gpu.*of_levels, core.*of_levels, core.*misses / (cores * gpu.*misses));
    }
  }
  return view;
}

sim::Json time_json(const CoreTime& t) {
  return {{"kernels", t.kernels},
          {"switches", t.switches},
          {"banks", t.banks},
          {"data_misses", levels_json(t.data_levels, t.data_misses)},
          {"boxes", t.boxes},
          {"triangles", t.triangles},
          {"pipes", t.pipes},
          {"tree_misses", levels_json(t.tree_levels, t.tree_misses)},
          {"raster", t.raster},
          {"raster_misses", levels_json(t.raster_levels, t.raster_misses)},
          {"transfers", t.transfers},
          {"no_tile", t.no_tile},
          {"demands",
           {{"no_slots", t.demands.no_slots},
            {"fed", t.demands.fed},
            {"occupied", t.demands.occupied},
            {"tree_lines", t.demands.tree_lines},
            {"tree_waits", t.demands.tree_waits},
            {"tests", t.demands.tests},
            {"data_lines", t.demands.data_lines},
            {"l2_lines", t.demands.l2_lines},
            {"port_lines", t.demands.port_lines},
            {"dram_bus", t.demands.dram_bus},
            {"dram_busy", t.demands.dram_busy},
            {"dram_queue", t.demands.dram_queue},
            {"transfers", t.demands.transfers},
            {"spills", t.demands.spills},
            {"spilling", t.demands.spilling},
            {"spill_lines", t.demands.spill_lines},
            {"tracing", t.demands.tracing},
            {"records", t.demands.records}}}};
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
    parts.emplace_back(
        all, fmt::format("{} {:.0f} %{}", word_for(name), 100 * all, inner.empty() ? "" : fmt::format(" ({})", inner)));
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
    const double more = after.cycles * sum_of_levels(after.time.at(name)) - before.cycles * sum_of_levels(share);
    if (more > most.cycles) most = {word_for(name), more};
  }
  return most;
}

}  // namespace tools
