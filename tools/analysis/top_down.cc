#include "tools/analysis/top_down.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/frame/memory_interface.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/memory/unit_names.h"
#include "hw_models/raster/raster_unit.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
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

double ratio(auto a, auto b) { return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b); }

/// Average latency of the machine's L2 seen from its ports, and the part of it for which DRAM is waited for, in ns.
struct Beyond {
  double l2 = 0, dram = 0;
};

Beyond beyond(std::span<const UnitReport> units) {
  const Units<hw::L2Bank> banks(units);
  const double ns = 1000 / banks.clock_mhz();
  const std::uint64_t requests = banks.counted(&L2Stats::reads);
  return {ns * ratio(banks.counted(&L2Stats::latency), requests),
          ns * ratio(banks.counted(&L2Stats::memory_cycles), requests)};
}

/// `latency`: of a miss, in ns.
MissLevels levels(double latency, const Beyond& b) {
  if (latency == 0) return {};
  const double dram = std::min(b.dram, latency), l2 = std::clamp(b.l2 - b.dram, 0.0, latency - dram);
  return {(latency - dram - l2) / latency, l2 / latency, dram / latency};
}

/// Work of the rays inside a T&I unit, as shares of the time in which traversal units have any.
struct Inside {
  double boxes = 0, triangles = 0, misses = 0;
};

template <class Unit>
double misses_of(const Units<Unit>& units) {
  using Reason = typename Unit::CycleReason;
  return units.share(Reason::kL1Miss) + units.share(Reason::kMshrFull) + units.share(Reason::kRauFull);
}

Inside inside(const Trvs& trvs, const Ists& ist) {
  const double there = 1 - trvs.share(OfTrv::kStarved), leaves = 1 - ist.share(OfIst::kStarved);
  const double at_ist = ratio(trvs.share(OfTrv::kIst), there);
  return {ratio(trvs.share(OfTrv::kVisiting) + trvs.share(OfTrv::kSerial), there),
          at_ist * ratio(ist.share(OfIst::kTesting), leaves),
          ratio(misses_of(trvs), there) + at_ist * ratio(misses_of(ist), leaves)};
}

/// Lines that a first-level cache can have on their way at once.
double mshrs(const hw::TniConfig& config, const hw::CacheConfig& cache) {
  return config.miss_handling == hw::MissHandling::kBlocking ? 1 : cache.mshrs;
}

double record_share(std::span<const UnitReport> units, const Units<hw::L2Bank>& banks) {
  using Stats = hw::MemoryInterface::Stats;
  const Units<hw::MemoryInterface> records(units);
  std::uint64_t requests = 0;
  for (const auto kind : {&Stats::ray_reads, &Stats::ray_writes, &Stats::hit_reads, &Stats::hit_writes})
    requests += records.counted(kind);
  return ratio(requests, banks.counted(&L2Stats::reads) + banks.counted(&L2Stats::writes));
}

/// Time for all visits at the pace of times when every ray slot was taken; that of all times where there were too few.
double tracing_demand(const Trvs& trvs) {
  const double occupied = 1 - trvs.share(OfTrv::kStarved), full = ratio(trvs.counted(&TrvStats::full), trvs.elapsed());
  if (full < 0.02) return occupied;
  return std::min(occupied, full * ratio(trvs.counted(&TrvStats::visits), trvs.counted(&TrvStats::full_visits)));
}

/// The rasteriser gets that part of the time without rays in which it was not idle, divided by what it did over the
/// frame: the array may wait for other things meanwhile, but mostly launches wait for what it finds.
void part_from_transfers(const Units<hw::RasterUnit>& rasteriser, const Beyond& memory, CoreTime& t) {
  const double busy = rasteriser.empty() ? 0 : 1 - rasteriser.share(OfRaster::kIdle);
  if (busy == 0) return;
  const double misses = rasteriser.share(OfRaster::kMemory) + rasteriser.share(OfRaster::kPortFull);
  const double awaited = std::min(t.transfers, busy);
  t.transfers -= awaited;
  t.raster_misses = awaited * misses / busy;
  t.raster = awaited - t.raster_misses;
  t.raster_levels = levels(memory.l2, memory);
}

CoreTime core_time(std::span<const UnitReport> units, const std::string& core, const Beyond& memory,
                   const hw::GpuConfig& config) {
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
  t.demands = {
      .no_slots = srp.share(OfSrp::kNoSlots),
      .fed = ratio(srp.counted(&SrpStats::fed), srp.elapsed()),
      .occupied = 1 - trvs.share(OfTrv::kStarved),
      .tree_lines = std::max(
          ratio(trvs.counted(&TrvStats::l1_miss_cycles), trvs.elapsed()) / mshrs(config.tni, config.tni.trv.l1),
          ratio(ist.counted(&hw::Ist::Stats::l1_miss_cycles), ist.elapsed()) / mshrs(config.tni, config.tni.ist.l1)),
      .data_lines = ratio(srp.counted(&SrpStats::cache_miss_cycles), srp.elapsed()) / config.srp.data_cache.mshrs,
      .l2_lines = ratio(banks.counted(&L2Stats::line_cycles), banks.elapsed()) / config.l2.mshrs_per_bank(),
      .dram_bus = data_bus_share(units),
      .tracing = tracing_demand(trvs),
      .records = record_share(units, banks)};
  const double tracing = ratio(srp.counted(&SrpStats::awaited), srp.elapsed());
  t.transfers = std::max(0.0, srp.share(OfSrp::kWaiting) + srp.share(OfSrp::kBorders) + t.demands.no_slots - tracing);
  part_from_transfers(Units<hw::RasterUnit>(units, core), memory, t);
  const Inside in = inside(trvs, ist);
  t.boxes = tracing * in.boxes;
  t.triangles = tracing * in.triangles;
  t.tree_misses = tracing * in.misses;
  t.pipes = tracing - t.boxes - t.triangles - t.tree_misses;
  const double srp_ns = 1000 / srp.clock_mhz(), tni_ns = 1000 / trvs.clock_mhz();
  t.data_levels =
      levels(srp_ns * ratio(srp.counted(&SrpStats::cache_miss_cycles), srp.counted(&SrpStats::cache_fills)), memory);
  t.tree_levels =
      levels(tni_ns * ratio(trvs.counted(&TrvStats::l1_miss_cycles) + ist.counted(&hw::Ist::Stats::l1_miss_cycles),
                            trvs.counted(&TrvStats::l1_fills) + ist.counted(&hw::Ist::Stats::l1_fills)),
             memory);
  return t;
}

/// Calls f(member of a, same member of b) for every share and demand of a CoreTime.
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
       {&Demands::no_slots, &Demands::fed, &Demands::occupied, &Demands::tree_lines, &Demands::data_lines,
        &Demands::l2_lines, &Demands::dram_bus, &Demands::tracing, &Demands::records}) {
    f(a.demands.*demand, b.demands.*demand);
  }
}

/// Time that kinds of caches spend on misses, and the levels that it is spent on.
constexpr std::array<std::pair<double CoreTime::*, MissLevels CoreTime::*>, 3> kMisses = {
    {{&CoreTime::data_misses, &CoreTime::data_levels},
     {&CoreTime::tree_misses, &CoreTime::tree_levels},
     {&CoreTime::raster_misses, &CoreTime::raster_levels}}};

/// Adds the levels of a core's misses to those of all: a core counts as much as it missed.
void add_levels(MissLevels& all, const MissLevels& core, double weight) {
  for (double MissLevels::*level : {&MissLevels::interconnect, &MissLevels::l2, &MissLevels::dram}) {
    all.*level += core.*level * weight;
  }
}

nlohmann::ordered_json levels_json(const MissLevels& l, double share) {
  return {{"interconnect", share * l.interconnect}, {"l2", share * l.l2}, {"dram", share * l.dram}};
}

/// The name of a part or level in words.
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

/// A share, or the sum of those of its levels.
double sum_of_levels(const nlohmann::ordered_json& share) {
  double all = 0;
  for (const auto& [level, part] : share.items()) all += part.get<double>();
  return all;
}

}  // namespace

double data_bus_share(std::span<const UnitReport> units) {
  const Units<hw::DramChannel> channels(units);
  return channels.share(hw::DramCycleReason::kReading) + channels.share(hw::DramCycleReason::kWriting);
}

TopDown top_down(std::span<const UnitReport> units, const hw::GpuConfig& config) {
  const Beyond memory = beyond(units);
  TopDown view;
  for (std::uint32_t c = 0; !Units<hw::Srp>(units, hw::name_in_core(hw::Srp::kName, c)).empty(); ++c) {
    view.cores.push_back(core_time(units, hw::name_in_core("core.", c), memory, config));
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

nlohmann::ordered_json time_json(const CoreTime& t) {
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
            {"data_lines", t.demands.data_lines},
            {"l2_lines", t.demands.l2_lines},
            {"dram_bus", t.demands.dram_bus},
            {"tracing", t.demands.tracing},
            {"records", t.demands.records}}}};
}

nlohmann::ordered_json top_down_json(const TopDown& view) {
  nlohmann::ordered_json out = {{"gpu", time_json(view.gpu)}, {"cores", nlohmann::ordered_json::array()}};
  for (const CoreTime& core : view.cores) out["cores"].push_back(time_json(core));
  return out;
}

std::string top_down_text(const nlohmann::ordered_json& time) {
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
