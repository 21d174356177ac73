#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/run/frame/power.h"
#include "tools/studies/dvfs/dvfs.h"

namespace tools {
namespace {

using sim::Json;

std::string marks_of(const DvfsCurve& curve, std::size_t i) {
  std::string marks;
  const auto mark = [&](bool is, const char* name) {
    if (is) marks += (marks.empty() ? "" : ", ") + std::string(name);
  };
  mark(i == curve.energy_optimal, "energy-optimal");
  mark(i == curve.race_to_idle && curve.points[i].period_mj >= 0, "race to idle");
  mark(i == curve.least_a_period && curve.points[i].period_mj >= 0, "least a period");
  return marks;
}

}  // namespace

std::string dvfs_text(const DvfsCurve& curve) {
  sim::Table table({"clocks x", "MHz", "V", "ms", "frames/s", "W", "mJ a frame", "frames/J", "mJ a period", ""});
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const DvfsPoint& p = curve.points[i];
    std::string mhz, volt;
    for (std::size_t d = 0; d < p.mhz.size(); ++d) {
      mhz += fmt::format("{}{:.4g}", d == 0 ? "" : "/", p.mhz[d]);
      volt += fmt::format("{}{:.3f}", d == 0 ? "" : "/", p.volt[d]);
    }
    table.add_row({fmt::format("{:.4g}", p.factor), mhz, volt, sim::four_digits(p.ms), sim::four_digits(p.fps()),
                   sim::four_digits(p.watt()), sim::four_digits(p.mj.nominal), sim::four_digits(1000 / p.mj.nominal),
                   p.period_mj < 0 ? std::string("too slow") : sim::four_digits(p.period_mj), marks_of(curve, i)});
  }
  const bool is_met = curve.points[curve.least_a_period].period_mj >= 0;
  return fmt::format(
      "clocks and voltages of T&I units / shader cores / L2; the memory's clock stays\n\n{}\n"
      "a period is {} ms, {} frames/s: a frame, then idle{}\n",
      table.text(), sim::four_digits(curve.period_ms), sim::four_digits(1000 / curve.period_ms),
      is_met ? "" : "; no clock of the curve is fast enough");
}

Json dvfs_json(const DvfsCurve& curve) {
  Json points = Json::array();
  for (const DvfsPoint& p : curve.points) {
    Json mhz = Json::object(), volt = Json::object();
    for (std::size_t d = 0; d < p.mhz.size(); ++d) {
      mhz[std::string(clock_domains()[d].name)] = p.mhz[d];
      volt[std::string(clock_domains()[d].name)] = p.volt[d];
    }
    points.push_back({{"factor", p.factor},
                      {"mhz", mhz},
                      {"volt", volt},
                      {"cycles", p.cycles},
                      {"time_ms", p.ms},
                      {"fps", p.fps()},
                      {"energy_mj", sim::band_json(p.mj)},
                      {"power_w", p.watt()},
                      {"idle_mw", p.idle_mw},
                      {"period_mj", p.period_mj < 0 ? Json(nullptr) : Json(p.period_mj)}});
  }
  return {
      {"schema", "raywatt-dvfs/1"},
      {"period_ms", curve.period_ms},
      {"energy_optimal", curve.energy_optimal},
      {"race_to_idle", curve.race_to_idle},
      {"least_a_period", curve.points[curve.least_a_period].period_mj < 0 ? Json(nullptr) : Json(curve.least_a_period)},
      {"warnings", curve.warnings},
      {"points", points}};
}

}  // namespace tools
