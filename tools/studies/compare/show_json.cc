
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/analysis/picture.h"
#include "tools/studies/compare/compare.h"

namespace tools {
namespace {

using sim::Json;

Json pairs_json(const std::vector<Pair>& pairs) {
  Json out = Json::array();
  for (const Pair& pair : pairs) {
    out.push_back({{"name", pair.name}, {"a", pair.a}, {"b", pair.b}, {"difference", pair.difference()}});
  }
  return out;
}

Json ratio_json(const EnergyRatio& r) {
  return {{"together", sim::band_json(r.together)},
          {"median", r.drawn.median},
          {"interval", {r.drawn.from, r.drawn.to}},
          {"less", r.b_less}};
}

Json energy_json(const Comparison& c) {
  if (!c.energy) return {{"why_not", sim::printable(c.no_energy, 1000)}};
  Json bars = Json::array();
  for (const TornadoBar& bar : c.energy->tornado) {
    bars.push_back({{"entry", bar.entry}, {"at_low", bar.at_low}, {"at_high", bar.at_high}});
  }
  return {{"draws", kEnergyDraws},
          {"seed", kEnergySeed},
          {"gpu", ratio_json(c.energy->gpu)},
          {"tni", ratio_json(c.energy->tni)},
          {"tornado", std::move(bars)}};
}

Json against_json(const Comparison& c) {
  Json config = Json::array(), figures = Json::object();
  for (const KeyPair& key : c.config) config.push_back({{"key", key.key}, {"a", key.a}, {"b", key.b}});
  for (const Pair& pair : c.figures) {
    Json& figure = figures[pair.name];
    figure = {{"a", pair.a}, {"b", pair.b}, {"relative", pair.a == 0 ? Json() : Json(pair.b / pair.a)}};
    if (!pair.noise) continue;
    figure["noise"] = {{"from", pair.noise->measured ? "replicates" : "default"},
                       {"difference", pair.noise->relative},
                       {"half_width", pair.noise->half_width},
                       {"outside", pair.noise->outside}};
  }
  Json picture = Json::object();
  if (c.squared_error) {
    const std::optional<double> psnr = psnr_db(*c.squared_error);
    picture = {{"identical", !psnr}, {"psnr_db", psnr ? Json(*psnr) : Json()}};
  } else {
    picture = {{"why_not", sim::printable(c.no_picture)}};
  }
  return {{"other_work", c.other_work},
          {"config", config},
          {"figures", figures},
          {"time", pairs_json(c.time)},
          {"reasons", pairs_json(c.reasons)},
          {"ratios", pairs_json(c.ratios)},
          {"energy_by_block_mj", pairs_json(c.blocks)},
          {"energy_by_event_mj", pairs_json(c.events)},
          {"energy_ratio", energy_json(c)},
          {"counters", pairs_json(c.counters)},
          {"picture", picture}};
}

}  // namespace

Json comparison_json(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  Json out = {{"schema", "raywatt-compare/1"},
              {"a", sim::printable(reports.front().file.string(), 4096)},
              {"against", Json::array()}};
  for (std::size_t i = 0; i < against.size(); ++i) {
    Json entry = {{"b", sim::printable(reports[i + 1].file.string(), 4096)}};
    entry.update(against_json(against[i]));
    out["against"].push_back(std::move(entry));
  }
  return out;
}

}  // namespace tools
