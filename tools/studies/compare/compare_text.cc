#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/analysis/picture.h"
#include "tools/studies/compare/compare.h"

namespace tools {
namespace {

constexpr std::size_t kShown = 8;  ///< lines per list; --json has all

/// "+1.42" per cent, "x3.19"
std::string relative_text(double relative) {
  return relative < 1 ? fmt::format("{:+.{}f}", 100 * relative, std::abs(relative) < 0.1 ? 2 : 1)
                      : fmt::format("x{:.3g}", 1 + relative);
}

/// Returns the noise of a difference: "within ± 2 %", or for means of replicates "mean +1.4 ± 0.52 %, outside".
std::string noise_text(const Comparison& c, const MetricPair& pair) {
  if (c.is_meaningless(pair.name)) return "another clock";
  if (!pair.noise) return "";
  const NoisyDifference& n = *pair.noise;
  constexpr double kRounding = 1e-12;
  const bool is_of_means = n.measured || std::abs(n.relative - (pair.b / pair.a - 1)) > kRounding;
  if (pair.a == pair.b && !is_of_means) return "";
  const char* const verdict = n.outside ? "outside" : "within";
  if (!is_of_means) return fmt::format("{} ± {:.2g} %", verdict, 100 * n.half_width);
  return fmt::format("mean {} ± {:.2g} %, {}", relative_text(n.relative), 100 * n.half_width, verdict);
}

/// Returns the source of the noise.
std::string noise_note(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  bool measured = false, assumed = false;
  for (const Comparison& c : against) {
    for (const MetricPair& pair : c.metrics) {
      if (!noise_text(c, pair).empty() && pair.noise) (pair.noise->measured ? measured : assumed) = true;
    }
  }
  std::string out;
  if (measured) out += "noise: differences of the means of replicates, 95 % intervals\n";
  if (!assumed) return out;
  const auto has_replicates = [](const ReportFile& report) { return report.has("totals.replicates.count"); };
  return out +
         (std::ranges::any_of(reports, has_replicates)
              ? "noise: assumed for this size of picture, or of one run's replicates if larger"
              : "noise: assumed for this size of picture") +
         "; --replicates 5 measures it\n";
}

/// "raywatt-out/base/report.json" -> "base".
std::string short_name(const ReportFile& report) {
  const std::filesystem::path file = report.file.lexically_normal();
  const std::string folder = file.parent_path().filename().string();
  const bool usual = file.filename() == "report.json" && !folder.empty() && folder != "." && folder != "..";
  return sim::printable(usual ? folder : file.stem().string(), 40);
}

std::string metric_value_text(const std::string& name, double value) {
  static const std::map<std::string, const char*> kUnits = {
      {"time_ms", "ms"}, {"dram_bytes", "B"},        {"energy_mj", "mJ"},  {"energy_tni_mj", "mJ"},
      {"power_w", "W"},  {"mrays_per_s", "Mrays/s"}, {"nj_per_ray", "nJ"}, {"area_mm2", "mm2"}};
  const auto unit = kUnits.find(name);
  if (name == "dram_bytes") return sim::si_text(value, "B");
  if (unit == kUnits.end()) return sim::si_text(value);
  return fmt::format("{:.4g} {}", value, unit->second);
}

std::string picture_text(const Comparison& c) {
  if (!c.squared_error) return sim::printable(c.no_picture);
  const std::optional<double> psnr = psnr_db(*c.squared_error);
  return psnr ? fmt::format("PSNR {:.2f} dB", *psnr) : "identical";
}

std::string overview_text(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  const std::vector<std::string> names = short_names(reports);
  std::vector<std::string> header = {"", names.front()};
  for (std::size_t i = 1; i < names.size(); ++i) header.insert(header.end(), {names[i], "", "noise"});
  sim::Table table(header);
  for (const MetricPair& first : against.front().metrics) {
    std::vector<std::string> row = {first.label, metric_value_text(first.name, first.a)};
    for (const Comparison& c : against) {
      const auto pair = std::ranges::find(c.metrics, first.name, &MetricPair::name);
      if (pair == c.metrics.end()) row.insert(row.end(), {"-", "", ""});
      if (pair == c.metrics.end()) continue;
      row.insert(row.end(), {metric_value_text(pair->name, pair->b), change_text(*pair), noise_text(c, *pair)});
    }
    table.add_row(std::move(row));
  }
  std::vector<std::string> pictures = {"picture", ""};
  for (const Comparison& c : against) pictures.insert(pictures.end(), {picture_text(c), "", ""});
  table.add_row(std::move(pictures));
  return table.text() + noise_note(reports, against);
}

enum class Column : std::uint8_t { kCount, kEnergy, kRatio };

std::string cell_text(Column column, double value) {
  if (column == Column::kEnergy) return fmt::format("{:.4g}", value);
  if (column == Column::kRatio) return value <= 1 ? fmt::format("{:.1f} %", 100 * value) : fmt::format("{:.1f}", value);
  return sim::si_text(std::abs(value) < 1000 ? std::round(value) : value);
}

/// Returns the first lines of a list. `whole`: the sum of all differences, or 0 if unknown.
std::string pairs_table(const std::string& title, const std::vector<MetricPair>& pairs, Column column,
                        const std::vector<std::string>& names, double whole = 0) {
  if (pairs.empty()) return {};
  std::vector<std::string> header = {title, names[0], names[1], "difference", ""};
  sim::Table table(std::move(header));
  const std::size_t shown = column == Column::kRatio ? pairs.size() : std::min(pairs.size(), kShown);
  for (std::size_t i = 0; i < shown; ++i) {
    const MetricPair& pair = pairs[i];
    const double difference = pair.difference();
    std::string moved = (difference > 0 ? "+" : "") + cell_text(column, difference);
    if (column == Column::kRatio) {
      const bool is_share = std::max(pair.a, pair.b) <= 1;
      moved = fmt::format("{:+.2f}{}", is_share ? 100 * difference : difference, is_share ? " points" : "");
    }
    table.add_row({pair.name, cell_text(column, pair.a), cell_text(column, pair.b), moved,
                   whole != 0                 ? fmt::format("{:.0f} % of the change", 100 * difference / whole)
                   : column == Column::kRatio ? ""
                                              : change_text(pair)});
  }
  const std::string rest = shown < pairs.size() ? fmt::format("and {} more\n", pairs.size() - shown) : "";
  return "\n" + table.text() + rest;
}

double difference_of(const Comparison& c, const char* metric) {
  const auto found = std::ranges::find(c.metrics, metric, &MetricPair::name);
  return found == c.metrics.end() ? 0 : found->difference();
}

std::string config_text(const Comparison& c) {
  if (c.config.empty()) return "configurations are equal\n";
  std::string out = "configuration\n";
  const auto value = [](const std::string& text) { return text.empty() ? "none" : text; };
  for (std::size_t i = 0; i < std::min(c.config.size(), 2 * kShown); ++i) {
    out += fmt::format("  {}: {} -> {}\n", c.config[i].key, value(c.config[i].a), value(c.config[i].b));
  }
  if (c.config.size() > 2 * kShown) out += fmt::format("  and {} more keys\n", c.config.size() - 2 * kShown);
  return out;
}

/// Returns the ratio of energies under all tables, and the entries with the largest effect.
std::string energy_text(const Comparison& c, const std::vector<std::string>& names) {
  if (!c.energy) return "\nno energy bands: " + sim::printable(c.no_energy, 1000) + "\n";
  sim::Table ratios({fmt::format("energy over {}", names[0]), "low tables", "nominal", "high", "median of draws",
                     "95 % interval", "less in"});
  const auto row = [&](const char* name, const EnergyRatio& r) {
    ratios.add_row({name, fmt::format("{:.4f}", r.together.low), fmt::format("{:.4f}", r.together.nominal),
                    fmt::format("{:.4f}", r.together.high), fmt::format("{:.4f}", r.drawn.median),
                    fmt::format("{:.4f} .. {:.4f}", r.drawn.from, r.drawn.to),
                    fmt::format("{:.1f} %", 100 * r.b_less)});
  };
  row("GPU with memory", c.energy->gpu);
  row("T&I alone", c.energy->tni);
  std::string out =
      fmt::format("\n{}{} draws of all entries of the tables between low and high\n", ratios.text(), kEnergyDraws);
  const auto energy = std::ranges::find(c.metrics, "energy_mj", &MetricPair::name);
  if (energy != c.metrics.end() && energy->noise && !energy->noise->outside) {
    out += "of the tables alone: the energies of these runs differ by no more than the noise above\n";
  }
  const std::vector<TornadoBar>& bars = c.energy->tornado;
  if (bars.empty()) return out;
  sim::Table table({"entries that move it most", "at its low", "at its high"});
  for (std::size_t i = 0; i < std::min(bars.size(), kShown); ++i) {
    table.add_row({bars[i].entry, fmt::format("{:.4f}", bars[i].at_low), fmt::format("{:.4f}", bars[i].at_high)});
  }
  return out + "\n" + table.text() + (bars.size() > kShown ? fmt::format("and {} more\n", bars.size() - kShown) : "");
}

std::string explanation_text(const Comparison& c, const std::vector<std::string>& names) {
  const bool has_places = !c.time.empty();
  std::string out = fmt::format("\n{} against {}: {}", names[1], names[0], config_text(c));
  out += pairs_table(c.other_clock ? "cycles of an average core, each of its own clock" : "cycles of an average core",
                     in_words(c.time), Column::kCount, names, difference_of(c, "cycles"));
  out += pairs_table("cycles of an average unit", c.reasons, Column::kCount, names);
  out += pairs_table("rates and mean times", c.ratios, Column::kRatio, names);
  out += pairs_table("mJ by block", c.blocks, Column::kEnergy, names, difference_of(c, "energy_mj"));
  out += pairs_table("mJ by event", c.events, Column::kEnergy, names, difference_of(c, "energy_mj"));
  out += energy_text(c, names);
  out += pairs_table("counters that changed most", c.counters, Column::kCount, names);
  if (!has_places && c.events.empty() && c.counters.empty()) out += "\nall counters are equal\n";
  return out;
}

}  // namespace

std::string change_text(const MetricPair& pair) {
  if (pair.a == pair.b) return "=";
  if (pair.a == 0) return "new";
  if (pair.b == 0) return "gone";
  const double times = pair.b / pair.a;
  if (times >= 2) return fmt::format("x{:.3g}", times);
  const double percent = 100 * (times - 1);
  return fmt::format("{:+.{}f} %", percent, std::abs(percent) < 1 ? 2 : 1);
}

std::vector<std::string> short_names(const std::vector<ReportFile>& reports) {
  std::vector<std::string> names;
  for (const ReportFile& report : reports) names.push_back(short_name(report));
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::ranges::count(names, names[i]) > 1) {
      for (std::size_t k = 0; k < names.size(); ++k)
        names[k] = fmt::format("{}:{}", static_cast<char>('A' + k % 26), names[k]);
      break;
    }
  }
  return names;
}

std::vector<MetricPair> in_words(std::vector<MetricPair> times) {
  static const std::map<std::string, const char*> kWords = {
      {"kernels", "kernels"},
      {"switches", "kernel switches"},
      {"banks", "tile-buffer banks"},
      {"boxes", "box tests"},
      {"triangles", "triangle tests"},
      {"pipes", "T&I pipelines"},
      {"raster", "rasteriser"},
      {"transfers", "transfers"},
      {"no_tile", "no tile"},
      {"data_misses.dram", "data-cache misses: DRAM"},
      {"data_misses.l2", "data-cache misses: L2"},
      {"data_misses.interconnect", "data-cache misses: interconnect"},
      {"tree_misses.dram", "tree misses: DRAM"},
      {"tree_misses.l2", "tree misses: L2"},
      {"tree_misses.interconnect", "tree misses: interconnect"},
      {"raster_misses.dram", "rasteriser's misses: DRAM"},
      {"raster_misses.l2", "rasteriser's misses: L2"},
      {"raster_misses.interconnect", "rasteriser's misses: interconnect"}};
  for (MetricPair& time : times) {
    if (const auto word = kWords.find(time.name); word != kWords.end()) time.name = word->second;
  }
  return times;
}

std::string comparison_text(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  const std::vector<std::string> names = short_names(reports);
  std::string out = overview_text(reports, against);
  for (std::size_t i = 0; i < against.size(); ++i) out += explanation_text(against[i], {names[0], names[i + 1]});
  return out;
}

namespace {

using sim::Json;

Json pairs_json(const std::vector<MetricPair>& pairs) {
  Json out = Json::array();
  for (const MetricPair& pair : pairs) {
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
  Json config = Json::array(), metrics = Json::object();
  for (const KeyPair& key : c.config) config.push_back({{"key", key.key}, {"a", key.a}, {"b", key.b}});
  for (const MetricPair& pair : c.metrics) {
    Json& metric = metrics[pair.name];
    metric = {{"a", pair.a}, {"b", pair.b}, {"relative", pair.a == 0 ? Json() : Json(pair.b / pair.a)}};
    if (!pair.noise) continue;
    metric["noise"] = {{"from", pair.noise->measured ? "replicates" : "default"},
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
          {"figures", metrics},
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
