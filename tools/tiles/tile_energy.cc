#include "tools/tiles/tile_energy.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <span>
#include <string_view>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/report/energy_formula.h"
#include "tools/run/frame/power.h"
#include "tools/tiles/residence.h"
#include "tools/tiles/tile_weights.h"

namespace tools {
namespace {

using Shares = std::vector<double>;

/// Returns the core of a unit, by its path.
std::optional<std::uint32_t> core_of(std::string_view path) {
  constexpr std::string_view kCore = "core";
  std::uint32_t core = 0;
  if (!path.starts_with(kCore)) return {};
  const auto [end, bad] = std::from_chars(path.data() + kCore.size(), path.data() + path.size(), core);
  return bad == std::errc{} && *end == '.' ? std::optional(core) : std::nullopt;
}

/// Energy to be shared out, by the quantity that it is shared by.
class Shared {
 public:
  Shared(const FrameResult& s, const TileWeights& weights, std::optional<std::uint32_t> core)
      : s_(s), weights_(weights), core_(core), counted_(weights.count()) {}

  void add(std::size_t weight, const sim::Spread& pj) { counted_[weight] += pj; }
  void add_standing(const sim::Spread& pj) { standing_ += pj; }

  void share_out(TileEnergy& energy) const {
    for (std::size_t w = 0; w < counted_.size(); ++w) {
      if (counted_[w].high == 0) continue;
      const double all = weights_.sum(w, core_);
      if (all == 0) {
        energy.rest += counted_[w];
        continue;
      }
      const sim::Spread each = counted_[w] * (1 / all);
      for_tiles([&](std::size_t tile) { energy.tiles[tile] += each * weights_.of(tile, w); });
      if (!core_) energy.rest += each * weights_.of_rest(w);
    }
    const Residence present = residence(s_.tile_accounts, s_.elapsed, core_);
    for_tiles([&](std::size_t tile) { energy.tiles[tile] += standing_ * present.tiles[tile]; });
    energy.rest += standing_ * present.rest;
  }

 private:
  void for_tiles(auto&& f) const {
    for (std::size_t tile = 0; tile < s_.tile_accounts.size(); ++tile) {
      if (!core_ || s_.tile_accounts[tile].core == *core_) f(tile);
    }
  }

  const FrameResult& s_;
  const TileWeights& weights_;
  const std::optional<std::uint32_t> core_;
  std::vector<sim::Spread> counted_;
  sim::Spread standing_{0, 0, 0};
};

}  // namespace

TileEnergy tile_energy(const FrameResult& s, const RunConfig& config) {
  const auto device_events = hw::dram_energy_events(config.gpu->dram);
  const sim::EnergyFormula formula(s.units, config.energy, device_events, s.elapsed, power_scales(config));
  const std::vector<sim::EnergyFormula::UnitEnergy> units = formula.of_units();
  const TileWeights weights(s);
  TileEnergy energy{std::vector<sim::Spread>(s.tile_accounts.size(), sim::Spread{0, 0, 0}), {0, 0, 0}};
  std::vector<Shared> of_cores;
  for (std::uint32_t core = 0; core < s.machine->cores; ++core) of_cores.emplace_back(s, weights, core);
  Shared of_all(s, weights, {});
  for (std::size_t u = 0; u < units.size(); ++u) {
    const std::optional<std::uint32_t> core = core_of(s.units[u].path);
    Shared& shared = core ? of_cores[*core] : of_all;
    shared.add_standing(units[u].standing);
    std::size_t event = 0;
    for (const sim::CounterReport& counter : s.units[u].counters) {
      if (counter.event.empty()) continue;
      const sim::Spread& pj = units[u].events[event++];
      const std::optional<std::size_t> weight = TileWeights::of_counter(s.units[u], counter.name);
      weight ? shared.add(*weight, pj) : shared.add_standing(pj);
    }
  }
  for (const Shared& shared : of_cores) shared.share_out(energy);
  of_all.share_out(energy);
  return energy;
}

}  // namespace tools
