#include "tools/analysis/replicated.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/table.h"
#include "tools/noise/noise.h"

namespace tools {

using sim::Json;

namespace {

sim::JsonPointer pointer_to(const std::string& path) {
  std::string pointer = "/" + path;
  std::ranges::replace(pointer, '.', '/');
  return sim::JsonPointer(pointer);
}

std::string path_of(const std::string& pointer) {
  std::string path = pointer.substr(1);
  std::ranges::replace(path, '/', '.');
  return path;
}

/// Returns "6.764 ± 0.12 %".
std::string give_or_take(const Json& metrics, const char* path) {
  const Json& f = metrics.at(pointer_to(path));
  const double mean = f["mean"].get<double>();
  const double half = (f["high"].get<double>() - f["low"].get<double>()) / 2;
  return fmt::format("{} ± {:.2g} %", sim::four_digits(mean), mean == 0 ? 0 : 100 * half / mean);
}

double pixels_of(const ReportFile& report) { return report.number("resolution[0]") * report.number("resolution[1]"); }

}  // namespace

Json replicates_json(const ComparedResult& result, const Json& plain) {
  std::vector<Json> plays = {plain};
  for (std::size_t i = 0; i < result.run.replicates.size(); ++i) {
    const FrameResult* reference = result.reference == nullptr ? nullptr : &result.reference->replicates[i];
    plays.push_back(totals_json({result.run.replicates[i], reference, result.squared_error}));
  }
  Json out = {{"count", plays.size()}, {"level", 0.95}, {"figures", Json::object()}};
  const Json flat = plain.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number() || !is_noisy(path_of(pointer))) continue;
    const sim::JsonPointer at(pointer);
    const auto has_it = [&](const Json& play) { return play.contains(at); };
    if (!std::ranges::all_of(plays, has_it)) continue;
    std::vector<double> values;
    for (const Json& play : plays) values.push_back(play.at(at).get<double>());
    const Draws draws = draws_of(values);
    out["figures"][at] = {{"mean", draws.mean},
                          {"deviation", draws.deviation},
                          {"low", draws.mean - draws.half_width()},
                          {"high", draws.mean + draws.half_width()},
                          {"values", values}};
  }
  return out;
}

std::string replicates_text(const Json& replicates) {
  const Json& f = replicates["figures"];
  return fmt::format("{} runs, mean and 95 %: cycles {}, mJ {}, W {}, frames/J {}", replicates["count"].get<int>(),
                     give_or_take(f, "cycles"), give_or_take(f, "energy_mj.nominal"),
                     give_or_take(f, "power_w.nominal"), give_or_take(f, "perf.frames_per_joule_gpu"));
}

std::string replicates_table(const Json& replicates) {
  constexpr const char* kMetrics[] = {"cycles",
                                      "time_ms",
                                      "perf.fps",
                                      "perf.mrays_per_s",
                                      "dram_bytes",
                                      "utilisation.tni",
                                      "utilisation.srp",
                                      "utilisation.dram",
                                      "energy_mj.nominal",
                                      "energy_by_block_mj.tni.nominal",
                                      "power_w.nominal",
                                      "perf.frames_per_joule_gpu",
                                      "perf.frames_per_joule_tni",
                                      "perf.nj_per_ray",
                                      "relative.speedup",
                                      "relative.dram_bytes",
                                      "relative.tni_perf_per_watt",
                                      "relative.gpu_perf_per_watt"};
  sim::Table table({fmt::format("{} runs", replicates["count"].get<int>()), "mean", "deviation", "95 %, low", "high"});
  for (const char* path : kMetrics) {
    const sim::JsonPointer at = pointer_to(path);
    if (!replicates["figures"].contains(at)) continue;
    const Json& metric = replicates["figures"].at(at);
    std::vector<std::string> cells = {path};
    for (const char* part : {"mean", "deviation", "low", "high"}) {
      cells.push_back(sim::four_digits(metric[part].get<double>()));
    }
    table.add_row(std::move(cells));
  }
  return table.text();
}

std::optional<Draws> draws_in(const ReportFile& report, const std::string& metric) {
  const std::string at = "totals.replicates.figures." + metric;
  if (!report.has(at + ".mean")) return std::nullopt;
  return Draws{static_cast<std::size_t>(report.number("totals.replicates.count")), report.number(at + ".mean"),
               report.number(at + ".deviation")};
}

std::optional<NoisyDifference> noisy_difference(const ReportFile& a, const ReportFile& b, const std::string& metric) {
  const double of_a = a.number("totals." + metric), of_b = b.number("totals." + metric);
  if (!is_noisy(metric) || of_a == 0 || of_b == 0) return std::nullopt;
  const std::optional<Draws> draws_a = draws_in(a, metric), draws_b = draws_in(b, metric);
  double assumed = default_noise(std::min(pixels_of(a), pixels_of(b)), metric);
  for (const auto& draws : {draws_a, draws_b}) {
    if (draws) assumed = std::max(assumed, noise_of_pair(*draws));
  }
  const auto seen = [&](double value, const std::optional<Draws>& draws) {
    return draws ? SeenFigure{draws->mean, draws} : SeenFigure{value, {}, assumed};
  };
  const SeenFigure seen_a = seen(of_a, draws_a), seen_b = seen(of_b, draws_b);
  const MeanDifference d = difference_of(seen_a, seen_b);
  return NoisyDifference{d.value / seen_a.value, d.half_width() / seen_a.value, draws_a && draws_b,
                         std::abs(d.value) > d.half_width()};
}

}  // namespace tools
