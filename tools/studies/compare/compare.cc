#include "tools/studies/compare/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hw_models/machines/unit_kinds.h"
#include "tools/analysis/report_file.h"
#include "tools/analysis/report_paths.h"

namespace tools {
namespace {

using sim::Json;

/// Figures that people look at first: a name, and where a report has it.
constexpr std::array<std::pair<const char*, const char*>, 15> kFigures = {{
    {"cycles", "totals.cycles"},
    {"time_ms", "totals.time_ms"},
    {"fps", "totals.perf.fps"},
    {"rays", "totals.rays.total"},
    {"mrays_per_s", "totals.perf.mrays_per_s"},
    {"traversal_steps", "totals.traversal_steps"},
    {"dram_bytes", "totals.dram_bytes"},
    {"energy_mj", "totals.energy_mj.nominal"},
    {"energy_tni_mj", "totals.energy_by_block_mj.tni.nominal"},
    {"power_w", "totals.power_w.nominal"},
    {"frames_per_joule_gpu", "totals.perf.frames_per_joule_gpu"},
    {"frames_per_joule_tni", "totals.perf.frames_per_joule_tni"},
    {"nj_per_ray", "totals.perf.nj_per_ray"},
    {"area_mm2", "totals.area_mm2"},
    {"traced_ratio", "totals.traced_ratio"},
}};

/// By more than the rounding of a quotient or a sum.
bool differ(const Pair& pair) {
  constexpr double kRounding = 1e-13;
  return std::abs(pair.difference()) > kRounding * std::max(std::abs(pair.a), std::abs(pair.b));
}

void sort_by_difference(std::vector<Pair>& pairs) {
  std::erase_if(pairs, [](const Pair& pair) { return !differ(pair); });
  std::ranges::stable_sort(pairs, std::greater<>(), [](const Pair& pair) { return std::abs(pair.difference()); });
}

/// All paths of either report that begin with `prefix`, without it.
std::set<std::string> paths_below(const std::string& prefix, const ReportFile& a, const ReportFile& b) {
  std::set<std::string> out;
  for (const ReportFile* report : {&a, &b}) {
    for (auto at = report->numbers.lower_bound(prefix); at != report->numbers.end() && at->first.starts_with(prefix);
         ++at) {
      out.insert(at->first.substr(prefix.size()));
    }
  }
  return out;
}

std::vector<KeyPair> config_difference(const ReportFile& a, const ReportFile& b) {
  const auto config_of = [](const ReportFile& report) {
    return report.json.contains("config") ? flat_config(report.json["config"]) : FlatConfig{};
  };
  const FlatConfig of_a = config_of(a), of_b = config_of(b);
  FlatConfig all = of_a;
  all.insert(of_b.begin(), of_b.end());
  std::vector<KeyPair> out;
  for (const auto& [key, value] : all) {
    const auto at_a = of_a.find(key), at_b = of_b.find(key);
    KeyPair pair{key, at_a == of_a.end() ? "" : at_a->second, at_b == of_b.end() ? "" : at_b->second};
    if (pair.a != pair.b) out.push_back(std::move(pair));
  }
  return out;
}

std::vector<Pair> times(const ReportFile& a, const ReportFile& b) {
  const std::string prefix = "totals.top_down.gpu.";
  std::vector<Pair> out;
  for (const std::string& part : paths_below(prefix, a, b)) {
    if (part.starts_with("demands.")) continue;
    out.push_back({part, a.number(prefix + part) * a.number("totals.cycles"),
                   b.number(prefix + part) * b.number("totals.cycles")});
  }
  sort_by_difference(out);
  return out;
}

/// Is this a path of unit_sums()? No part of it but "l2" ends in a number.
bool is_sum(const ReportFile& report, const std::string& unit) { return report.has("units." + unit + ".units"); }

/// Time in which a unit does nothing, or the tile buffer just keeps: what the other reasons leave.
bool is_rest(std::string_view unit, std::string_view reason) {
  const std::optional<sim::ReasonKind> kind = hw::kind_of_reason(unit, reason);
  return kind == sim::ReasonKind::kIdle || (unit == hw::TileBuffer::kName && kind == sim::ReasonKind::kBackground);
}

/// T&I cycles that an average unit of a kind gave to a reason.
double mean_cycles(const ReportFile& report, const std::string& unit, const std::string& reason) {
  const double elapsed = report.number("units." + unit + ".elapsed");
  return elapsed == 0 ? 0
                      : report.number("units." + unit + ".why." + reason) / elapsed * report.number("totals.cycles");
}

std::vector<Pair> reasons(const ReportFile& a, const ReportFile& b) {
  std::vector<Pair> out;
  for (const std::string& path : paths_below("units.", a, b)) {
    const std::size_t why = path.find(".why.");
    if (why == std::string::npos) continue;
    const std::string unit = path.substr(0, why), reason = path.substr(why + 5);
    if (!is_sum(a, unit) && !is_sum(b, unit)) continue;
    if (is_rest(unit, reason)) continue;
    out.push_back({unit + " " + reason, mean_cycles(a, unit, reason), mean_cycles(b, unit, reason)});
  }
  sort_by_difference(out);
  return out;
}

std::vector<Pair> blocks(const ReportFile& a, const ReportFile& b) {
  const std::string prefix = "totals.energy_by_block_mj.";
  std::vector<Pair> out;
  for (const std::string& path : paths_below(prefix, a, b)) {
    if (!path.ends_with(".nominal")) continue;
    out.push_back({path.substr(0, path.find('.')), a.number(prefix + path), b.number(prefix + path)});
  }
  sort_by_difference(out);
  return out;
}

std::vector<Pair> events(const ReportFile& a, const ReportFile& b) {
  const std::string prefix = "totals.energy_by_event_mj.", kinds = "totals.energy_by_kind_mj.";
  std::vector<Pair> out;
  for (const std::string& path : paths_below(prefix, a, b)) {
    const std::size_t dot = path.find('.');
    out.push_back({path.substr(0, dot) + " " + path.substr(dot + 1), a.number(prefix + path), b.number(prefix + path)});
  }
  for (const char* kind : {"clock", "leakage"}) {
    const std::string path = kinds + kind + ".nominal";
    out.push_back({std::string("all ") + kind, a.number(path), b.number(path)});
  }
  sort_by_difference(out);
  return out;
}

/// The larger of the two is so many times the other, or without end.
double factor(const Pair& pair) {
  const auto [low, high] = std::minmax(pair.a, pair.b);
  return low == 0 ? std::numeric_limits<double>::infinity() : high / low;
}

std::vector<Pair> counters(const ReportFile& a, const ReportFile& b) {
  const double least = 0.01 * std::max(a.number("totals.rays.total"), b.number("totals.rays.total"));
  std::vector<Pair> out;
  for (const std::string& path : paths_below("units.", a, b)) {
    const std::size_t at = path.find(".counters.");
    if (at == std::string::npos) continue;
    const std::string unit = path.substr(0, at);
    if (!is_sum(a, unit) && !is_sum(b, unit)) continue;
    const std::string full = "units." + path;
    out.push_back({unit + " " + path.substr(at + 10), a.number(full), b.number(full)});
  }
  for (const std::string group : {"rays", "dram_bytes_by_client", "sampling"}) {
    for (const std::string& name : paths_below("totals." + group + ".", a, b)) {
      const std::string full = fmt::format("totals.{}.{}", group, name);
      out.push_back({group + " " + name, a.number(full), b.number(full)});
    }
  }
  sort_by_difference(out);
  std::erase_if(out, [&](const Pair& pair) { return std::abs(pair.difference()) <= least; });
  std::ranges::stable_sort(out, std::greater<>(), factor);
  return out;
}

/// "9 frames, 2 to 10" of several.
std::string frames_text(const ReportFile& report) {
  const auto frames = report.json.find("frames");
  const std::size_t count = frames != report.json.end() && frames->is_array() ? frames->size() : 0;
  const auto number = [&](std::size_t i) { return report.number(fmt::format("frames[{}].frame", i)); };
  return count == 0 ? "none" : fmt::format("{} to {}", number(0), number(count - 1));
}

std::string program_of(const ReportFile& report) {
  const auto program = report.json.find("program");
  return program != report.json.end() && program->is_string() ? program->get<std::string>() : "unknown";
}

std::vector<std::string> other_work(const ReportFile& a, const ReportFile& b) {
  std::vector<std::string> out;
  const auto check = [&](const char* what, const std::string& of_a, const std::string& of_b) {
    if (of_a != of_b) out.push_back(fmt::format("{}: {} and {}", what, of_a, of_b));
  };
  const auto size = [](const ReportFile& r) {
    return fmt::format("{}x{}", r.number("resolution[0]"), r.number("resolution[1]"));
  };
  check("scenes", a.text("scene", "name"), b.text("scene", "name"));
  if (out.empty() && a.text("provenance", "scene_sha256") != b.text("provenance", "scene_sha256")) {
    out.emplace_back("scenes: of the same name, but not the same (scene_sha256)");
  }
  check("programs", program_of(a), program_of(b));
  check("resolutions", size(a), size(b));
  check("frames", frames_text(a), frames_text(b));
  return out;
}

}  // namespace

Comparison compare(const ReportFile& a, const ReportFile& b) {
  Comparison out;
  out.other_work = other_work(a, b);
  out.config = config_difference(a, b);
  out.other_clock = std::ranges::find(out.config, "clocks.tni", &KeyPair::key) != out.config.end();
  for (const auto& [name, path] : kFigures) {
    const bool says_nothing =
        path == std::string_view("totals.traced_ratio") && a.number(path) == 1 && b.number(path) == 1;
    if (!says_nothing && (a.has(path) || b.has(path))) {
      const std::string figure = metric_name(path);
      out.figures.push_back({name, a.number(path), b.number(path), {}, figure});
      if (!out.says_nothing_of(figure)) out.figures.back().noise = noisy_difference(a, b, figure);
    }
  }
  out.time = times(a, b);
  out.reasons = reasons(a, b);
  out.blocks = blocks(a, b);
  out.events = events(a, b);
  out.counters = counters(a, b);
  out.ratios = ratios(a, b);
  compare_energy(a, b, out);
  compare_pictures(a, b, out);
  return out;
}

std::vector<std::string> comparison_warnings(const std::vector<ReportFile>& reports,
                                             const std::vector<Comparison>& against) {
  std::vector<std::string> out;
  const std::string first = reports.front().file.string();
  for (const ReportFile& report : reports) {
    const auto partial = report.json.find("partial");
    if (partial != report.json.end() && *partial == true) {
      out.push_back(fmt::format("{}: is of a run that was interrupted", report.file.string()));
    }
    if (report.has("totals.sampled.tiles")) {
      out.push_back(fmt::format("{}: figures are estimates (--tile-sampling), which may explain small differences",
                                report.file.string()));
    }
    if (report.has("totals.sliced.cycles.estimate")) {
      out.push_back(fmt::format("{}: figures are sums of slices (--slices), which may explain small differences",
                                report.file.string()));
    }
    if (report.has("totals.extrapolated") && report.number("totals.extrapolated") > 0) {
      out.push_back(
          fmt::format("{}: has figures beyond what the tables cover, as its warnings[] say", report.file.string()));
    }
  }
  for (std::size_t i = 0; i < against.size(); ++i) {
    const std::string name = reports[i + 1].file.string();
    for (const std::string& what : against[i].other_work) {
      out.push_back(fmt::format("{} and {} had other work to do: {}", first, name, what));
    }
    if (against[i].other_clock) {
      out.push_back(
          fmt::format("{} and {} have T&I clocks of their own (clocks.tni): compare times, not cycles", first, name));
    }
    const auto model = [](const ReportFile& report) { return report.text("provenance", "model_id"); };
    if (model(reports[0]) != model(reports[i + 1])) {
      out.push_back(
          fmt::format("{} and {} were made by different models (model_id): the program explains "
                      "differences as well as the configuration does",
                      first, name));
    }
  }
  return out;
}

}  // namespace tools
