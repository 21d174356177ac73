#include "tools/pricing/energy_study.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace tools {
namespace {

constexpr std::string_view kByBlock = "totals.energy_by_block_mj.", kNominal = ".nominal";

}  // namespace

double band_energy_pj(const PricedRun& run, const std::string& block, sim::BandMember member) {
  if (block == kPeriod) return run.period_energy_pj(member);
  return block.empty() ? run.total(member) : run.block_energy_pj(block, member);
}

std::optional<EnergyMetric> energy_metric(std::string_view path) {
  if (path == "totals.energy_mj.nominal" || path == "totals.power_w.nominal" || path == "totals.perf.nj_per_ray") {
    return EnergyMetric{};
  }
  if (path == "totals.power_at_fps_w.nominal") return EnergyMetric{std::string(kPeriod)};
  if (path == "totals.perf.frames_per_joule_gpu" || path == "totals.perf.frames_per_joule_per_mm2")
    return EnergyMetric{"", true};
  if (path == "totals.perf.frames_per_joule_tni") return EnergyMetric{"tni", true};
  if (!path.starts_with(kByBlock) || !path.ends_with(kNominal)) return std::nullopt;
  path.remove_prefix(kByBlock.size());
  path.remove_suffix(kNominal.size());
  return EnergyMetric{std::string(path), false};
}

double nominal_energy_pj(const PricedRun& run, const std::string& block) {
  return band_energy_pj(run, block, &sim::Band::nominal);
}

std::vector<double> energy_by_draw_pj(PricedRun& run, const std::string& block, std::uint64_t draws,
                                      std::uint64_t seed) {
  std::vector<double> out;
  out.reserve(draws);
  for (std::uint64_t i = 0; i < draws; ++i) {
    run.apply_draw({seed, i});
    out.push_back(nominal_energy_pj(run, block));
  }
  run.restore_nominal();
  return out;
}

Interval95 interval_of(std::vector<double> samples) {
  std::ranges::sort(samples);
  const auto quantile = [&](double q) {
    const double at = q * static_cast<double>(samples.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, samples.size() - 1);
    return samples[below] + (samples[above] - samples[below]) * (at - static_cast<double>(below));
  };
  return {quantile(0.025), quantile(0.5), quantile(0.975)};
}

EnergyRatio energy_ratio(PricedRun& a, PricedRun& b, const std::string& block) {
  EnergyRatio out;
  for (const sim::BandMember side : sim::kBandMembers)
    out.together.*side = band_energy_pj(b, block, side) / band_energy_pj(a, block, side);
  const std::vector<double> of_a = energy_by_draw_pj(a, block), of_b = energy_by_draw_pj(b, block);
  std::vector<double> ratios;
  std::size_t less = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    ratios.push_back(of_b[i] / of_a[i]);
    less += ratios.back() < 1 ? 1 : 0;
  }
  out.b_less = static_cast<double>(less) / static_cast<double>(ratios.size());
  out.drawn = interval_of(std::move(ratios));
  return out;
}

double TornadoBar::ratio_swing() const { return std::abs(std::log(at_high / at_low)); }

std::vector<std::string> entries_of(const std::vector<PricedRun*>& runs) {
  std::vector<std::string> names;
  std::set<std::string> known;
  for (PricedRun* run : runs) {
    for (const EnergyEntry& entry : run->band_entries()) {
      if (known.insert(entry.name).second) names.push_back(entry.name);
    }
  }
  return names;
}

void set_single_entry(PricedRun& run, const std::string& entry, double quantile) {
  for (EnergyEntry& e : run.band_entries()) {
    e.restore_nominal();
    if (e.name == entry) e.set_quantile(quantile);
  }
  run.update_formula();
}

std::vector<TornadoBar> tornado_bars(PricedRun& a, PricedRun& b, const std::string& block) {
  std::vector<TornadoBar> bars;
  for (const std::string& entry : entries_of({&a, &b})) {
    const auto ratio = [&](double quantile) {
      set_single_entry(a, entry, quantile);
      set_single_entry(b, entry, quantile);
      return nominal_energy_pj(b, block) / nominal_energy_pj(a, block);
    };
    TornadoBar bar{entry, ratio(0), 0};
    bar.at_high = ratio(1);
    if (bar.at_low != bar.at_high) bars.push_back(std::move(bar));
  }
  a.restore_nominal();
  b.restore_nominal();
  std::ranges::stable_sort(bars, std::greater<>(), &TornadoBar::ratio_swing);
  return bars;
}

}  // namespace tools
