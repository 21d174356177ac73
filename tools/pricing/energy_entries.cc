#include "tools/pricing/energy_entries.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "sim/config/config_tree.h"
#include "sim/hash.h"

namespace tools {
namespace {

std::uint64_t hash_of(const std::string& name) {
  std::uint64_t h = 0;
  for (const char c : name) h = sim::hash(h, static_cast<unsigned char>(c));
  return h;
}

void add(std::vector<EnergyEntry>& entries, const sim::ConfigNode& node, const std::string& key, sim::Spread& figure) {
  const std::string name = key.empty() ? node.path : node.path + "." + key;
  const std::string entry = sim::event_of(name);
  if (entries.empty() || entries.back().name != entry) {
    entries.push_back({entry, node.unit, node.meaning, hash_of(entry), {}});
  }
  entries.back().figures.push_back({name, &figure, figure});
}

void collect(const sim::ConfigNode& group, std::vector<EnergyEntry>& entries) {
  for (const sim::ConfigNode& node : group.children) {
    if (node.path == "area" || node.path == "power") continue;  // no energy figures
    if (node.is_group()) {
      collect(node, entries);
    } else if (node.affects != sim::Affects::kEnergy) {
      continue;
    } else if (auto* const figure = std::get_if<sim::Spread*>(&*node.target)) {
      add(entries, node, "", **figure);
    } else if (auto* const map = std::get_if<std::map<std::string, sim::Spread>*>(&*node.target)) {
      for (auto& [key, spread] : **map) add(entries, node, key, spread);
    }
  }
}

}  // namespace

bool EnergyEntry::has_band() const {
  return std::ranges::any_of(figures, [](const Figure& f) { return f.band.low != f.band.high; });
}

void EnergyEntry::set_quantile(double quantile) {
  for (const Figure& f : figures) f.value->nominal = at_quantile(f.band, quantile);
}

void EnergyEntry::restore() {
  for (const Figure& f : figures) *f.value = f.band;
}

std::vector<EnergyEntry> energy_entries(RunConfig& config) {
  std::vector<EnergyEntry> entries;
  collect(sim::config_tree(config), entries);
  return entries;
}

double at_quantile(const sim::Spread& band, double quantile) {
  const bool lower = quantile < 0.5;
  const double from = lower ? band.low : band.nominal, to = lower ? band.nominal : band.high;
  const double part = lower ? 2 * quantile : 2 * quantile - 1;
  return from > 0 ? from * std::pow(to / from, part) : from + (to - from) * part;
}

double EnergyDraw::quantile(const EnergyEntry& entry) const {
  return sim::unit_float(sim::hash(seed, number, entry.hash));
}

}  // namespace tools
