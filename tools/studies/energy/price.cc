#include "tools/studies/energy/price.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/studies/sweep/results/index/csv.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A run under two tables.
struct Priced {
  std::string name;
  std::vector<std::pair<std::string, std::string>> axes;  ///< axes of a point of a sweep
  Json own, asked;                                        ///< energy_totals_json()
  std::vector<FigureChange> changes;
};

Priced price(const std::string& name, const ReportFile& report, const PriceTable& table) {
  const PricedRun own(report), asked(report, table);
  return {name,
          {},
          energy_totals_json(own.energy(), own.work()),
          energy_totals_json(asked.energy(), asked.work()),
          figure_changes(own.config(), asked.config())};
}

std::vector<Priced> price_sweep(const fs::path& path, const PriceTable& table) {
  const auto folder = sweep::SweepFolder::open(path);
  std::vector<Priced> out;
  for (const sweep::Point& point : folder.points()) {
    const fs::path results = folder.store().folder(point.id);
    if (!fs::exists(results / "report.json")) continue;
    out.push_back(price(fmt::format("{}", point.n), load_report(results), table));
    out.back().axes = point.axes;
  }
  if (out.empty()) throw sim::InputError(fmt::format("{}: no point has a result yet", sim::printable(path.string())));
  return out;
}

double at(const Json& totals, const char* pointer) { return totals.at(Json::json_pointer(pointer)).get<double>(); }

std::string percent(double from, double to) { return fmt::format("{:+.1f} %", 100 * (to / from - 1)); }

std::string changes_text(const std::vector<FigureChange>& changes) {
  constexpr std::size_t kChangesShown = 16;
  if (changes.empty()) return "the table is the run's own\n";
  std::string out;
  for (std::size_t i = 0; i < std::min(changes.size(), kChangesShown); ++i) {
    out += fmt::format("  {}: {} -> {}\n", changes[i].name, changes[i].from, changes[i].to);
  }
  if (changes.size() > kChangesShown) out += fmt::format("  and {} more figures\n", changes.size() - kChangesShown);
  return out;
}

std::string run_text(const Priced& run) {
  std::string out = fmt::format("{}\n{}\n", sim::printable(run.name, 1000), changes_text(run.changes));
  sim::Table table({"mJ", "own nominal", "low", "nominal", "high", ""});
  const auto row = [&](const std::string& name, const Json& own, const Json& asked) {
    const auto number = [](const Json& s, const char* side) { return s[side].get<double>(); };
    table.row({name, fmt::format("{:.4f}", number(own, "nominal")), fmt::format("{:.4f}", number(asked, "low")),
               fmt::format("{:.4f}", number(asked, "nominal")), fmt::format("{:.4f}", number(asked, "high")),
               percent(number(own, "nominal"), number(asked, "nominal"))});
  };
  for (const auto& [block, s] : run.own["energy_by_block_mj"].items())
    row(block, s, run.asked["energy_by_block_mj"][block]);
  row("total", run.own["energy_mj"], run.asked["energy_mj"]);
  for (const auto& [kind, s] : run.own["energy_by_kind_mj"].items()) {
    row("of it " + kind, s, run.asked["energy_by_kind_mj"][kind]);
  }
  out += table.text();
  for (const auto& [name, pointer] : {std::pair{"W", "/power_w/nominal"},
                                      {"nJ per ray", "/perf/nj_per_ray"},
                                      {"frames/J GPU with memory", "/perf/frames_per_joule_gpu"},
                                      {"frames/J T&I alone", "/perf/frames_per_joule_tni"}}) {
    out += fmt::format("{} {}, by its own table {}\n", sim::four_digits(at(run.asked, pointer)), name,
                       sim::four_digits(at(run.own, pointer)));
  }
  return out;
}

/// Columns of a table of runs.
const std::vector<std::pair<const char*, const char*>>& columns() {
  static const std::vector<std::pair<const char*, const char*>> kColumns = {
      {"energy_mj.low", "/energy_mj/low"},
      {"energy_mj.nominal", "/energy_mj/nominal"},
      {"energy_mj.high", "/energy_mj/high"},
      {"power_w.nominal", "/power_w/nominal"},
      {"perf.frames_per_joule_gpu", "/perf/frames_per_joule_gpu"},
      {"perf.frames_per_joule_tni", "/perf/frames_per_joule_tni"}};
  return kColumns;
}

std::vector<std::string> axes_of(const std::vector<Priced>& runs) {
  std::vector<std::string> axes;
  for (const Priced& run : runs) {
    for (const auto& [axis, value] : run.axes) {
      if (std::ranges::find(axes, axis) == axes.end()) axes.push_back(axis);
    }
  }
  return axes;
}

std::string runs_table(const std::vector<Priced>& runs, bool csv) {
  const std::vector<std::string> axes = axes_of(runs);
  std::vector<std::string> header = {"run"};
  header.insert(header.end(), axes.begin(), axes.end());
  header.emplace_back("own energy_mj.nominal");
  for (const auto& [name, pointer] : columns()) header.emplace_back(name);
  sim::Table table(header);
  std::string lines = results::csv_line(header);
  for (const Priced& run : runs) {
    std::vector<std::string> row = {run.name};
    for (const std::string& axis : axes) {
      const auto found = std::ranges::find(run.axes, axis, [](const auto& a) { return a.first; });
      row.push_back(found == run.axes.end() ? "" : found->second);
    }
    const auto cell = [&](double value) { row.push_back(csv ? fmt::format("{}", value) : sim::four_digits(value)); };
    cell(at(run.own, "/energy_mj/nominal"));
    for (const auto& [name, pointer] : columns()) cell(at(run.asked, pointer));
    lines += results::csv_line(row);
    for (std::string& word : row) word = sim::printable(word);
    table.row(std::move(row));
  }
  return csv ? lines : table.text();
}

Json runs_json(const std::vector<Priced>& runs) {
  Json out = Json::array();
  for (const Priced& run : runs) {
    Json entry = {{"run", run.name}, {"axes", Json::object()}, {"changes", Json::array()}};
    for (const auto& [axis, value] : run.axes) entry["axes"][axis] = value;
    for (const FigureChange& c : run.changes) {
      entry["changes"].push_back({{"key", c.name}, {"from", c.from}, {"to", c.to}});
    }
    entry["own"] = run.own;
    entry["priced"] = run.asked;
    out.push_back(std::move(entry));
  }
  return out;
}

std::map<std::string, sim::Spread> figures_of(RunConfig config) {
  std::map<std::string, sim::Spread> out;
  for (const EnergyEntry& entry : energy_entries(config)) {
    for (const EnergyEntry::Figure& f : entry.figures) out[f.name] = f.band;
  }
  return out;
}

std::string band_text(const std::map<std::string, sim::Spread>& figures, const std::string& name) {
  const auto found = figures.find(name);
  if (found == figures.end()) return "none";
  const sim::Spread& s = found->second;
  if (s.low == s.high) return fmt::format("{} without a band", s.nominal);
  return fmt::format("{} / {} / {}", s.low, s.nominal, s.high);
}

}  // namespace

std::vector<FigureChange> figure_changes(const RunConfig& from, const RunConfig& to) {
  const auto a = figures_of(from), b = figures_of(to);
  auto all = a;
  all.insert(b.begin(), b.end());
  std::vector<FigureChange> out;
  for (const auto& [name, figure] : all) {
    FigureChange change{name, band_text(a, name), band_text(b, name)};
    if (change.from != change.to) out.push_back(std::move(change));
  }
  const auto keys = sim::list_fields(from), others = sim::list_fields(to);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!keys[i].path.starts_with("power.") || keys[i].value == others[i].value) continue;
    const bool is_table = keys[i].kind == sim::FieldKind::kSpreadMap;
    out.push_back({keys[i].path, is_table ? "a table" : keys[i].value, is_table ? "another" : others[i].value});
  }
  return out;
}

std::string price_text(const std::vector<fs::path>& paths, const PriceTable& table, PriceFormat format) {
  Json json = {{"schema", "raywatt-price/1"}, {"runs", Json::array()}};
  std::vector<Priced> all;
  std::string out;
  for (const fs::path& path : paths) {
    const bool is_sweep = fs::exists(path / "sweep.json");
    std::vector<Priced> runs;
    if (is_sweep) runs = price_sweep(path, table);
    if (!is_sweep) runs.push_back(price(path.string(), load_report(path), table));
    if (!out.empty()) out += '\n';
    if (format == PriceFormat::kJson) {
      for (Json& run : runs_json(runs)) json["runs"].push_back(std::move(run));
    } else if (format == PriceFormat::kCsv) {
      all.insert(all.end(), runs.begin(), runs.end());
    } else if (is_sweep) {
      out += fmt::format("{}\n{}\n{}", sim::printable(path.string(), 1000), changes_text(runs.front().changes),
                         runs_table(runs, false));
    } else {
      out += run_text(runs.front());
    }
  }
  if (format == PriceFormat::kJson) return sim::json_text(json);
  return format == PriceFormat::kCsv ? runs_table(all, true) : out;
}

}  // namespace tools
