#include "tools/tiles/tile_energy.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/machines/unit_kinds.h"
#include "hw_models/memory/messages.h"
#include "sim/io/json.h"
#include "sim/report/energy.h"
#include "tools/analysis/units.h"
#include "tools/run/frame/power.h"

namespace tools {

TileTimeShares tile_time_shares(std::span<const hw::TileAccount> tiles, sim::Time elapsed,
                                std::optional<std::uint32_t> core) {
  struct Event {
    sim::Time at;
    std::size_t tile;
    bool comes;
  };
  std::vector<Event> events;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (core && tiles[i].core != *core) continue;
    events.push_back({tiles[i].dispatched, i, true});
    events.push_back({tiles[i].finished, i, false});
  }
  std::ranges::stable_sort(events, {}, &Event::at);
  TileTimeShares shares{std::vector<double>(tiles.size()), 0};
  const auto whole = static_cast<double>(elapsed);
  // Share of time of an imaginary tile that is in flight from the start of the frame. A tile's own share is the value
  // at its end minus the value at its dispatch.
  double reached = 0;
  sim::Time now = 0;
  std::size_t present = 0;
  const auto advance = [&](sim::Time to) {
    const double share = static_cast<double>(to - now) / whole;
    if (present == 0) {
      shares.rest += share;
    } else {
      reached += share / static_cast<double>(present);
    }
    now = to;
  };
  for (const Event& event : events) {
    advance(event.at);
    present += event.comes ? 1 : std::size_t(-1);
    shares.tiles[event.tile] = event.comes ? reached : reached - shares.tiles[event.tile];
  }
  advance(elapsed);
  return shares;
}

namespace {

/// Kinds of work by which energy is shared. The kinds from kOperations on are counters of a shader core that depend on
/// its kernels.
enum Kind : std::size_t {
  kRays,
  kVisits,
  kTests,
  kNodeLines,
  kTriangleLines,
  kShadingLines,
  kTransferLines,
  kRecordLines,
  kRasterLines,
  kBuildLines,
  kCacheLines,
  kAccesses,
  kBufferAccesses,
  kSrpCycles,
  kL2Hits,
  kL2Misses,
  kL2Fills,
  kL2Writes,
  kDramReads,
  kDramWrites,
  kActivates,
  kOperations
};

/// Calls f(value, name) for each counter of a shader core.
void for_each_counter(const hw::SrpStats& stats, auto&& f) {
  hw::SrpStats::describe(stats, [&](const std::uint64_t& value, const char* name, auto&&...) { f(value, name); });
}

std::size_t srp_counters() {
  std::size_t count = 0;
  for_each_counter({}, [&](auto&&...) { count += 1; });
  return count;
}

std::size_t srp_counter(std::string_view wanted) {
  std::size_t count = 0, found = 0;
  for_each_counter({}, [&](std::uint64_t, std::string_view name) {
    if (name == wanted) found = count;
    count += 1;
  });
  return found;
}

/// A counter of a unit, and the kind of work by which its energy is shared out.
struct SharingRule {
  std::type_index unit;
  std::string_view counter;
  Kind kind;
};

template <class Unit>
SharingRule make_rule(std::uint64_t Unit::Stats::*counter, Kind kind) {
  return {typeid(Unit), counter_name<typename Unit::Stats>(counter), kind};
}

/// Rules for counters whose energy is shared by another kind of work than default_kind_of_work() returns for their
/// unit.
const std::vector<SharingRule>& special_rules() {
  using hw::CorePort, hw::DramChannel, hw::Ist, hw::L2Bank, hw::Srp, hw::Trv;
  static const std::vector<SharingRule> all = {
      make_rule<Trv>(&Trv::Stats::rays_in, kRays),
      make_rule<Trv>(&Trv::Stats::rays_out, kRays),
      make_rule<Trv>(&Trv::Stats::l1_misses, kNodeLines),
      make_rule<Trv>(&Trv::Stats::l1_fills, kNodeLines),
      make_rule<Trv>(&Trv::Stats::bypass_passes, kNodeLines),
      make_rule<Ist>(&Ist::Stats::l1_misses, kTriangleLines),
      make_rule<Ist>(&Ist::Stats::l1_fills, kTriangleLines),
      make_rule<Ist>(&Ist::Stats::bypass_passes, kTriangleLines),
      make_rule<Srp>(&Srp::Stats::rays, kRays),
      make_rule<Srp>(&Srp::Stats::hits, kRays),
      make_rule<Srp>(&Srp::Stats::config_reads, kSrpCycles),
      make_rule<Srp>(&Srp::Stats::config_rows_switched, kSrpCycles),
      make_rule<Srp>(&Srp::Stats::config_rows_loaded, kSrpCycles),
      make_rule<Srp>(&Srp::Stats::cache_hits, kAccesses),
      make_rule<Srp>(&Srp::Stats::cache_misses, kShadingLines),
      make_rule<Srp>(&Srp::Stats::cache_fills, kShadingLines),
      make_rule<L2Bank>(&L2Bank::Stats::hits, kL2Hits),
      make_rule<L2Bank>(&L2Bank::Stats::misses, kL2Misses),
      make_rule<L2Bank>(&L2Bank::Stats::fills, kL2Fills),
      make_rule<DramChannel>(&DramChannel::Stats::read_bursts, kDramReads),
      make_rule<DramChannel>(&DramChannel::Stats::write_bursts, kDramWrites),
      make_rule<DramChannel>(&DramChannel::Stats::activates, kActivates),
  };
  return all;
}

/// Returns the kind of work by which the energy of a unit's counters is shared, except for the counters in
/// special_rules(). Returns nothing if the energy is shared by time.
std::optional<Kind> default_kind_of_work(const sim::UnitReport& unit) {
  if (unit.type == typeid(hw::RayDispatcher) || unit.type == typeid(hw::PredictorStage)) return kRays;
  if (unit.type == typeid(hw::Trv)) return kVisits;
  if (unit.type == typeid(hw::Ist)) return kTests;
  if (unit.type == typeid(hw::TileBuffer)) return kBufferAccesses;
  if (unit.type == typeid(hw::Dma)) return kTransferLines;
  if (unit.type == typeid(hw::MemoryInterface)) return kRecordLines;
  if (unit.type == typeid(hw::RasterUnit)) return kRasterLines;
  if (unit.type == typeid(hw::TreeBuilder)) return kBuildLines;
  if (unit.type == typeid(hw::CorePort)) return unit.path.ends_with("dma_port") ? kTransferLines : kCacheLines;
  if (unit.type == typeid(hw::L2Bank)) return kL2Writes;
  return {};
}

std::uint64_t lines_of(const hw::TileAccount& account, hw::RequesterKind asker) {
  return account.lines[static_cast<std::size_t>(asker)];
}

/// Weights for sharing a machine's energy among tiles: for each tile and kind of work, the amount of that work.
class TileWeights {
 public:
  explicit TileWeights(const FrameResult& s)
      : s_(s), kinds_(kOperations + srp_counters()), values_(s.tile_accounts.size() * kinds_), rest_(kinds_) {
    if (s.rendered.summaries.tiles.size() < s.tile_accounts.size()) throw std::logic_error("tiles without a summary");
    for (std::size_t i = 0; i < s.tile_accounts.size(); ++i) {
      const kernels::TileSummary& tile = s.rendered.summaries.tiles[i];
      double* const values = &values_[i * kinds_];
      std::uint64_t rays = 0;
      for (const std::uint64_t of_kind : tile.rays) rays += of_kind;
      values[kRays] = static_cast<double>(rays);
      values[kVisits] = static_cast<double>(tile.steps - tile.tests);
      values[kTests] = static_cast<double>(tile.tests);
      values[kAccesses] = static_cast<double>(tile.accesses);
      add_account(s.tile_accounts[i], values);
    }
    add_account(s.rest, rest_.data());
    add_kernels(s);
  }

  /// Returns the number of kinds of work by which energy is shared.
  std::size_t kind_count() const { return kinds_; }
  double tile_weight(std::size_t tile, std::size_t kind) const { return values_[tile * kinds_ + kind]; }
  double weight_without_tile(std::size_t kind) const { return rest_[kind]; }
  /// Returns the total weight of a kind of work over the tiles of a core; without a core, over all tiles and over
  /// requests without a tile.
  double sum_of(std::size_t kind, std::optional<std::uint32_t> core) const {
    double all = core ? 0 : rest_[kind];
    for (std::size_t tile = 0; tile < s_.tile_accounts.size(); ++tile) {
      if (!core || s_.tile_accounts[tile].core == *core) all += tile_weight(tile, kind);
    }
    return all;
  }

  /// Returns the kind of work by which the energy of a unit's counter is shared; none if that energy depends on time.
  static std::optional<std::size_t> kind_of_counter(const sim::UnitReport& unit, std::string_view counter) {
    const auto is_it = [&](const SharingRule& rule) { return rule.unit == unit.type && rule.counter == counter; };
    const auto found = std::ranges::find_if(special_rules(), is_it);
    if (found != special_rules().end()) return found->kind;
    if (unit.type == typeid(hw::Srp)) return kOperations + srp_counter(counter);
    return default_kind_of_work(unit);
  }

 private:
  void add_account(const hw::TileAccount& account, double* values) const {
    using hw::RequesterKind;
    const auto set = [&](Kind kind, std::uint64_t value) { values[kind] = static_cast<double>(value); };
    set(kNodeLines, lines_of(account, RequesterKind::kNodes));
    set(kTriangleLines, lines_of(account, RequesterKind::kTriangles));
    set(kShadingLines, lines_of(account, RequesterKind::kShading));
    set(kTransferLines, lines_of(account, RequesterKind::kTransfers));
    set(kRecordLines, lines_of(account, RequesterKind::kRecords));
    set(kRasterLines, lines_of(account, RequesterKind::kRaster));
    set(kBuildLines, lines_of(account, RequesterKind::kBuild));
    for (const Kind kind : {kNodeLines, kTriangleLines, kShadingLines, kRecordLines, kRasterLines, kBuildLines}) {
      values[kCacheLines] += values[kind];
    }
    set(kSrpCycles, account.srp_cycles);
    set(kL2Hits, account.l2_hits);
    set(kL2Misses, account.l2_misses);
    set(kL2Fills, account.l2_fills);
    set(kL2Writes, account.l2_writes);
    set(kDramReads, account.dram_reads);
    set(kDramWrites, account.dram_writes);
    set(kActivates, account.activates);
  }
  /// Adds work to the tiles' weights: the operations of each tile's kernels, and the accesses to the tile buffer by
  /// kernels, rays, hits and transfers.
  void add_kernels(const FrameResult& s) {
    constexpr double kAccess = 16;          // bytes per access to the tile buffer
    std::vector<std::vector<double>> item;  // counters for one item of each kernel
    for (const hw::KernelSchedule& kernel : s.kernels) {
      hw::SrpStats one;
      one.add_loop(kernel, 1, 1);
      item.emplace_back();
      for_each_counter(one,
                       [&](std::uint64_t value, const char*) { item.back().push_back(static_cast<double>(value)); });
    }
    std::size_t next = 0;
    for (std::size_t i = 0; i < s.tile_accounts.size(); ++i) {
      const kernels::TileSummary& tile = s.rendered.summaries.tiles[i];
      double* const values = &values_[i * kinds_];
      values[kBufferAccesses] = values[kRays] * (2 * sizeof(traces::Ray) + 2 * sizeof(traces::Hit)) / kAccess +
                                static_cast<double>(tile.transfer_bytes) / kAccess;
      for (; next < tile.kernels; ++next) {
        const kernels::KernelItems& use = s.rendered.summaries.kernels[next];
        const hw::KernelSchedule& kernel = s.kernels[use.kernel];
        for (std::size_t c = 0; c < item[use.kernel].size(); ++c) {
          values[kOperations + c] += use.items * item[use.kernel][c];
        }
        values[kBufferAccesses] += use.items * static_cast<double>(kernel.local_reads + kernel.local_writes);
      }
    }
  }

  const FrameResult& s_;
  const std::size_t kinds_;
  std::vector<double> values_;  ///< one number per tile and kind of work, ordered by tile
  std::vector<double> rest_;
};

using Shares = std::vector<double>;

/// Returns the number of the core that a unit belongs to, from the unit's path; none for a unit outside all cores.
std::optional<std::uint32_t> core_of(std::string_view path) {
  constexpr std::string_view kCore = "core";
  std::uint32_t core = 0;
  if (!path.starts_with(kCore)) return {};
  const auto [end, bad] = std::from_chars(path.data() + kCore.size(), path.data() + path.size(), core);
  return bad == std::errc{} && *end == '.' ? std::optional(core) : std::nullopt;
}

/// Collects energy that is shared among tiles, separately for each kind of work by which it is shared.
class SharedEnergy {
 public:
  SharedEnergy(const FrameResult& s, const TileWeights& weights, std::optional<std::uint32_t> core)
      : s_(s), weights_(weights), core_(core), counted_(weights.kind_count()) {}

  void add(std::size_t weight, const sim::Band& pj) { counted_[weight] += pj; }
  void add_time_dependent(const sim::Band& pj) { standing_ += pj; }

  void distribute_energy(TileEnergy& energy) const {
    for (std::size_t w = 0; w < counted_.size(); ++w) {
      if (counted_[w].high == 0) continue;
      const double all = weights_.sum_of(w, core_);
      if (all == 0) {
        energy.rest += counted_[w];
        continue;
      }
      const sim::Band each = counted_[w] * (1 / all);
      for_each_tile([&](std::size_t tile) { energy.tiles[tile] += each * weights_.tile_weight(tile, w); });
      if (!core_) energy.rest += each * weights_.weight_without_tile(w);
    }
    const TileTimeShares present = tile_time_shares(s_.tile_accounts, s_.elapsed, core_);
    for_each_tile([&](std::size_t tile) { energy.tiles[tile] += standing_ * present.tiles[tile]; });
    energy.rest += standing_ * present.rest;
  }

 private:
  void for_each_tile(auto&& f) const {
    for (std::size_t tile = 0; tile < s_.tile_accounts.size(); ++tile) {
      if (!core_ || s_.tile_accounts[tile].core == *core_) f(tile);
    }
  }

  const FrameResult& s_;
  const TileWeights& weights_;
  const std::optional<std::uint32_t> core_;
  std::vector<sim::Band> counted_;
  sim::Band standing_{0, 0, 0};
};

}  // namespace

TileEnergy tile_energy(const FrameResult& s, const RunConfig& config) {
  const auto device_events = hw::dram_energy_events(config.gpu->dram);
  const sim::EnergyFormula formula(s.units, config.energy, device_events, s.elapsed, power_scales(config));
  const std::vector<sim::EnergyFormula::UnitEnergy> units = formula.unit_energies();
  const TileWeights weights(s);
  TileEnergy energy{std::vector<sim::Band>(s.tile_accounts.size(), sim::Band{0, 0, 0}), {0, 0, 0}};
  std::vector<SharedEnergy> of_cores;
  for (std::uint32_t core = 0; core < s.machine->cores; ++core) of_cores.emplace_back(s, weights, core);
  SharedEnergy of_all(s, weights, {});
  for (std::size_t u = 0; u < units.size(); ++u) {
    const std::optional<std::uint32_t> core = core_of(s.units[u].path);
    SharedEnergy& shared = core ? of_cores[*core] : of_all;
    shared.add_time_dependent(units[u].idle);
    std::size_t event = 0;
    for (const sim::CounterReport& counter : s.units[u].counters) {
      if (counter.event.empty()) continue;
      const sim::Band& pj = units[u].events[event++];
      const std::optional<std::size_t> weight = TileWeights::kind_of_counter(s.units[u], counter.name);
      weight ? shared.add(*weight, pj) : shared.add_time_dependent(pj);
    }
  }
  for (const SharedEnergy& shared : of_cores) shared.distribute_energy(energy);
  of_all.distribute_energy(energy);
  return energy;
}

namespace {

// must be the factor of reports, so that energies are equal to the last bit
constexpr double kMillijoulesPerPicojoule = 1e-9;

/// Returns the number that gives exactly `whole` when it is added to `sum`, in spite of rounding.
double exact_difference_to(double whole, double sum) {
  double rest = whole - sum;
  while (sum + rest < whole) rest = std::nextafter(rest, INFINITY);
  while (sum + rest > whole) rest = std::nextafter(rest, -INFINITY);
  return rest;
}

class Builder {
 public:
  Builder(const FrameResult& s, const RunConfig& config, std::uint32_t frame) : s_(s), config_(config) {
    frame_.frame = frame;
  }

  TileFrame build_frame() {
    add_position_columns();
    add_times();
    add_work_columns();
    add_memory();
    add_energy();
    return std::move(frame_);
  }

 private:
  /// Adds a column to the table; `value(i)` returns the value of tile i.
  TileColumn& add(std::string name, std::string unit, auto&& value) {
    TileColumn& column = frame_.columns.emplace_back(TileColumn{std::move(name), std::move(unit)});
    column.values.reserve(s_.tile_accounts.size());
    for (std::size_t i = 0; i < s_.tile_accounts.size(); ++i) {
      column.values.push_back(static_cast<double>(value(i)));
    }
    return column;
  }
  void add_sum(std::string name, std::string unit, double rest, auto&& value) {
    TileColumn& column = add(std::move(name), std::move(unit), value);
    column.is_sum = true;
    column.rest = rest;
    for (const double one : column.values) column.total += one;
    column.total += rest;
  }
  const kernels::TileSummary& summary_of(std::size_t i) const { return s_.rendered.summaries.tiles[i]; }
  const hw::TileAccount& account_of(std::size_t i) const { return s_.tile_accounts[i]; }

  void add_position_columns() {
    std::uint32_t pass = 0;
    add("tile", "", [&](std::size_t i) { return summary_of(i).tile; });
    add("pass", "", [&](std::size_t i) { return pass += summary_of(i).begins_pass ? 1U : 0U; });
    if (s_.rendered.pixels.empty()) return;
    const std::vector<const kernels::TileSummary*> firsts = first_passes();
    add("x", "pixels", [&](std::size_t i) { return firsts[i]->x; });
    add("y", "pixels", [&](std::size_t i) { return firsts[i]->y; });
    add("width", "pixels", [&](std::size_t i) { return firsts[i]->width; });
    add("height", "pixels", [&](std::size_t i) { return firsts[i]->height; });
  }
  /// Returns for each entry of the tile list the entry in the first pass that renders the same tile. Only entries of
  /// the first pass have the tile's position. A later pass over the frame numbers its tiles after those of the previous
  /// pass, in the same order.
  std::vector<const kernels::TileSummary*> first_passes() const {
    std::vector<const kernels::TileSummary*> by_tile, firsts;
    std::size_t count = 0;
    for (std::size_t i = 0; i < s_.tile_accounts.size() && !(i != 0 && summary_of(i).begins_pass); ++i) count += 1;
    by_tile.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (summary_of(i).tile < count) by_tile[summary_of(i).tile] = &summary_of(i);
    }
    for (std::size_t i = 0; i < s_.tile_accounts.size(); ++i) {
      const kernels::TileSummary* first = i < count ? nullptr : by_tile[summary_of(i).tile % count];
      firsts.push_back(first == nullptr ? &summary_of(i) : first);
    }
    return firsts;
  }
  void add_times() {
    const sim::Clock tni = config_.gpu->clocks.tni.clock();
    add("core", "", [&](std::size_t i) { return account_of(i).core; });
    add("dispatched", "T&I cycles", [&](std::size_t i) { return tni.cycles(account_of(i).dispatched); });
    add("finished", "T&I cycles", [&](std::size_t i) { return tni.cycles(account_of(i).finished); });
    add_sum("srp_cycles", "SRP cycles", static_cast<double>(s_.rest.srp_cycles),
            [&](std::size_t i) { return account_of(i).srp_cycles; });
  }
  void add_work_columns() {
    constexpr std::array kKinds = {"rays_primary", "rays_shadow", "rays_reflection", "rays_refraction"};
    static_assert(kKinds.size() == static_cast<std::size_t>(traces::RayKind::kCount));
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      add_sum(kKinds[k], "rays", 0, [&](std::size_t i) { return summary_of(i).rays[k]; });
    }
    add_sum("steps", "steps", 0, [&](std::size_t i) { return summary_of(i).steps; });
    add_sum("tests", "tests", 0, [&](std::size_t i) { return summary_of(i).tests; });
  }
  void add_memory() {
    const auto bytes = [](std::uint64_t lines) { return static_cast<double>(hw::kLineBytes * lines); };
    for (std::size_t a = 0; a < hw::kRequesterKinds; ++a) {
      add_sum(std::string("bytes_").append(names_of(hw::RequesterKind{})[a]), "bytes", bytes(s_.rest.lines[a]),
              [&](std::size_t i) { return bytes(account_of(i).lines[a]); });
    }
    add_sum("dram_bytes", "bytes", bytes(s_.rest.dram_reads + s_.rest.dram_writes),
            [&](std::size_t i) { return bytes(account_of(i).dram_reads + account_of(i).dram_writes); });
  }
  void add_energy() {
    const TileEnergy energy = tile_energy(s_, config_);
    const auto add_side = [&](const char* name, double sim::Band::*side) {
      add_sum(name, "mJ", 0, [&](std::size_t i) { return energy.tiles[i].*side * kMillijoulesPerPicojoule; });
      TileColumn& column = frame_.columns.back();
      const double whole = s_.energy.total_pj.*side * kMillijoulesPerPicojoule;
      column.rest = exact_difference_to(whole, column.total);
      column.total = whole;
    };
    add_side("energy_mj_low", &sim::Band::low);
    add_side("energy_mj_nominal", &sim::Band::nominal);
    add_side("energy_mj_high", &sim::Band::high);
  }

  const FrameResult& s_;
  const RunConfig& config_;
  TileFrame frame_;
};

}  // namespace

TileFrame compute_tile_table(const FrameResult& s, const RunConfig& config, std::uint32_t frame) {
  return Builder(s, config, frame).build_frame();
}

}  // namespace tools
