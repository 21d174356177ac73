#include "sim/report/report_json.h"

#include <string_view>

#include "sim/io/json.h"

namespace sim {
namespace {

constexpr double kMillijoulesPerPicojoule = 1e-9;

Json& at_path(Json& tree, std::string_view path) {
  const std::size_t dot = path.find('.');
  Json& branch = tree[std::string(path.substr(0, dot))];
  return dot == std::string_view::npos ? branch : at_path(branch, path.substr(dot + 1));
}

Json unit_json(Json node, const UnitReport& unit) {
  node["elapsed"] = unit.elapsed;
  node["why"] = Json::object();
  for (const auto& [reason, cycles] : unit.cycles_by_reason) node["why"][reason] = cycles;
  node["counters"] = Json::object();
  for (const CounterReport& counter : unit.counters) node["counters"][counter.name] = counter.value;
  return node;
}

}  // namespace

Json band_json(const Band& band, double factor) {
  return {{"low", band.low * factor}, {"nominal", band.nominal * factor}, {"high", band.high * factor}};
}

Json units_json(std::span<const UnitReport> units) {
  Json tree = Json::object();
  for (const UnitReport& unit : units) {
    Json& node = at_path(tree, unit.path);
    node = unit_json(std::move(node), unit);
  }
  return tree;
}

Json energy_json(const EnergyReport& energy) {
  Json json;
  json["energy_mj"] = band_json(energy.total_pj, kMillijoulesPerPicojoule);
  for (const auto& [block, kinds] : energy.blocks) {
    json["energy_by_block_mj"][block] = band_json(kinds.total(), kMillijoulesPerPicojoule);
  }
  for (const auto& [block, events] : energy.events) {
    Json& of_block = json["energy_by_event_mj"][block] = Json::object();
    for (const auto& [event, pj] : events) at_path(of_block, event) = pj.nominal * kMillijoulesPerPicojoule;
  }
  json["energy_by_kind_mj"] = {{"dynamic", band_json(energy.kinds.dynamic, kMillijoulesPerPicojoule)},
                               {"clock", band_json(energy.kinds.clock, kMillijoulesPerPicojoule)},
                               {"leakage", band_json(energy.kinds.leakage, kMillijoulesPerPicojoule)}};
  return json;
}

}  // namespace sim
