#include <algorithm>
#include <functional>
#include <string_view>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/report/table.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

using sim::si_text;

/// Speed-ups below this are none.
constexpr double kWorthSaying = 1.01;

struct Bound {
  std::string words;
  double speedup = 1;
};

std::string words_of(const std::string& resource) {
  const auto& all = hw::IdealConfig::kResources;
  const auto found = std::ranges::find(all, resource, [](const auto& each) { return std::string_view(each.name); });
  return found == all.end() ? resource : found->words;
}

/// Estimated worth of each resource made ideal, the largest first.
std::vector<Bound> bounds_of(const Run& run) {
  std::vector<Bound> bounds;
  const Json& estimates = at(run.totals(), {"bottleneck", "estimated_speedup"});
  if (!estimates.is_object()) return bounds;
  for (const auto& [name, speedup] : estimates.items()) {
    if (speedup.is_number()) bounds.push_back({words_of(name), speedup.get<double>()});
  }
  std::ranges::stable_sort(bounds, std::greater<>(), &Bound::speedup);
  return bounds;
}

std::string capital(std::string words) {
  if (!words.empty() && words[0] >= 'a' && words[0] <= 'z') words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return words;
}

/// A figure with its band, where totals have one.
Headline banded(const Run& run, const char* id, const char* name, const char* unit, const char* note) {
  const Json& spread = at(run.totals(), {id});
  Headline out{.id = id, .name = name, .value = at(spread, {"nominal"}), .unit = unit, .note = note};
  out.low = at(spread, {"low"});
  out.high = at(spread, {"high"});
  return out;
}

/// The 95 % interval of a figure, of a run whose tiles were sampled or cut into slices.
void add_interval(const Run& run, const char* figure, Headline& out) {
  const auto add = [&](const char* by, const char* note) {
    const Json& interval = at(run.totals(), {by, figure});
    if (!interval.is_object()) return;
    out.low = at(interval, {"low"});
    out.high = at(interval, {"high"});
    out.note = note;
  };
  add("sampled", "estimated from sampled tiles, 95 % interval");
  add("sliced", "sum of slices, 95 % interval");
}

}  // namespace

void add_verdict(const Run& run, View& view) {
  const std::vector<Bound> bounds = bounds_of(run);
  const std::vector<std::pair<std::string, std::string>> links = {{"where the cycles went", "cycles"},
                                                                  {"what each resource is worth", "bounds"}};
  if (bounds.empty()) {
    view.verdict("This report does not say what limits the run.", "It was made without an estimate of its limits.",
                 {{"where the cycles went", "cycles"}});
    return;
  }
  if (bounds.front().speedup < kWorthSaying) {
    view.verdict("No resource alone limits this run: none made perfect would be worth 1 %.", "", links);
  } else {
    std::string more = "An estimate from this run's counters; raywatt bottleneck measures it.";
    if (bounds.size() > 1)
      more = fmt::format("Next: {}, ×{:.2f} if perfect. {}", bounds[1].words, bounds[1].speedup, more);
    view.verdict(fmt::format("{} limit this run: ×{:.2f} if perfect.", capital(bounds[0].words), bounds[0].speedup),
                 more, links);
  }
  Dataset data({{"resource", "resource made ideal"}, {"speedup", "speed-up", Show::kNumber}, {"label", "shown"}});
  for (const Bound& bound : bounds)
    data.row({capital(bound.words), bound.speedup, fmt::format("×{:.2f}", bound.speedup)});
  view.data("bounds", data);
}

void add_headlines(const Run& run, View& view) {
  const auto figure = [&](const char* id, const char* name, const char* path, Show show, const char* unit,
                          const char* note = "") {
    if (!run.report.has(path)) return;
    Headline out{.id = id, .name = name, .value = run.number(path), .show = show, .unit = unit, .note = note};
    if (std::string_view(id) == "time_ms") add_interval(run, id, out);
    view.headline(out);
  };
  figure("time_ms", "Time", "totals.time_ms", Show::kNumber, "ms");
  figure("fps", "Frame rate", "totals.perf.fps", Show::kNumber, "frames/s");
  Headline energy = banded(run, "energy_mj", "Energy", "mJ", "GPU with memory, low to high");
  if (!energy.value.is_null()) view.headline(energy);
  if (Headline power = banded(run, "power_w", "Power", "W", "GPU with memory, low to high"); !power.value.is_null())
    view.headline(power);
  figure("frames_per_joule_gpu", "Efficiency", "totals.perf.frames_per_joule_gpu", Show::kNumber, "frames/J",
         "GPU with memory, nominal");
  figure("nj_per_ray", "Energy of a ray", "totals.perf.nj_per_ray", Show::kNumber, "nJ", "nominal");
  figure("mrays_per_s", "Ray rate", "totals.perf.mrays_per_s", Show::kNumber, "Mrays/s");
  figure("rays", "Rays", "totals.rays.total", Show::kSi, "");
  figure("cycles", "Cycles", "totals.cycles", Show::kSi, "", "of the T&I clock");
  if (Headline area = banded(run, "area_band_mm2", "Area", "mm²", "low to high"); !area.value.is_null()) {
    area.id = "area_mm2";
    view.headline(area);
  }
  const double traced = run.number("totals.traced_ratio");
  if (run.report.has("totals.traced_ratio") && traced != 1)
    figure("traced_ratio", "Samples traced", "totals.traced_ratio", Show::kPercent, "", "of those the picture has");
  if (at(run.totals(), {"identical"}).is_boolean()) {
    const bool is_identical = at(run.totals(), {"identical"}).get<bool>();
    view.headline({.id = "psnr_db",
                   .name = "Picture",
                   .value = is_identical ? Json("identical") : at(run.totals(), {"psnr_db"}),
                   .unit = is_identical ? "" : "dB",
                   .note = "PSNR against the reference program"});
    figure("speedup", "Speed", "totals.relative.speedup", Show::kNumber, "×", "against the reference program");
  }
  view.fact("Scene", fmt::format("{}, {}, {}", text_at(run.report.json, {"scene", "name"}),
                                 counted(run.number("scene.triangles"), "triangle"),
                                 counted(run.number("scene.lights"), "light")));
  view.fact("Picture", fmt::format("{}x{}", run.number("resolution[0]"), run.number("resolution[1]")));
  view.fact("Program", text_at(run.report.json, {"program"}));
  view.fact("Machine", fmt::format("{}, {} each, T&I at {}", counted(run.number("config.cores"), "core"),
                                   counted(run.number("config.tni.trvs"), "traversal unit"),
                                   text_at(run.report.json, {"config", "clocks", "tni"})));
  if (at(run.report.json, {"partial"}) == true)
    view.notice("This run was interrupted: its figures are those of the finished part.");
  if (run.report.has("totals.sampled.tiles") &&
      run.number("totals.sampled.timed") < run.number("totals.sampled.tiles")) {
    view.notice(fmt::format("Timed: {} of {}; all other figures are estimates.", run.number("totals.sampled.timed"),
                            counted(run.number("totals.sampled.tiles"), "tile")));
  }
  if (const Json& warnings = at(run.report.json, {"warnings"}); warnings.is_array()) {
    for (const Json& warning : warnings) {
      if (warning.is_string()) view.notice(warning.get<std::string>());
    }
  }
}

}  // namespace tools::pages
