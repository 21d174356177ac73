#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/energy/energy.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/store/store.h"

namespace tools {
namespace {

using sim::Json;
namespace fs = std::filesystem;

/// A value that differs between two energy tables; "none" if a table lacks it.
struct TableChange {
  std::string name, from, to;
};

/// The energy of a run under its own energy tables and under new ones.
struct RepricedRun {
  std::string run;                                          ///< path of the run or sweep
  std::string n{};                                          ///< number of the point; empty for a run outside a sweep
  std::vector<std::pair<std::string, std::string>> axes{};  ///< axis names and values of the point
  sim::Json own, repriced;                                  ///< energy_totals_json()
  std::vector<TableChange> changes;
  std::size_t plays = 1;                  ///< number of replicates of the run; the energy is that of the first
  std::vector<std::string> extrapolated;  ///< sizes of units for which the new table is extrapolated
};

constexpr double kJoulesPerPicojoule = 1e-12;

double number_in(const Json& totals, const char* pointer) { return totals.at(sim::JsonPointer(pointer)).get<double>(); }

std::string percent_text(double from, double to) { return fmt::format("{:+.1f} %", 100 * (to / from - 1)); }

std::string changes_text(const std::vector<TableChange>& changes) {
  constexpr std::size_t kChangesShown = 16;
  if (changes.empty()) return "the table is that of the run\n";
  std::string out;
  for (std::size_t i = 0; i < std::min(changes.size(), kChangesShown); ++i) {
    out += fmt::format("  {}: {} -> {}\n", changes[i].name, changes[i].from, changes[i].to);
  }
  if (changes.size() > kChangesShown) out += fmt::format("  and {} more values\n", changes.size() - kChangesShown);
  return out;
}

/// Returns notes on the reliability of the repriced energies.
std::string notes_text(const std::vector<RepricedRun>& runs) {
  std::set<std::size_t> plays;
  std::set<std::string> extrapolated;
  for (const RepricedRun& run : runs) {
    if (run.plays > 1) plays.insert(run.plays);
    extrapolated.insert(run.extrapolated.begin(), run.extrapolated.end());
  }
  std::string out;
  if (!plays.empty()) out += fmt::format("priced: the first of {} replicates\n", fmt::join(plays, " or "));
  for (const std::string& line : extrapolated) out += fmt::format("note: {}\n", line);
  return out;
}

std::string run_text(const RepricedRun& run) {
  std::string out = fmt::format("{}\n{}\n", sim::printable(run.run, 1000), changes_text(run.changes));
  sim::Table table({"mJ", "own nominal", "low", "nominal", "high", ""});
  const auto row = [&](const std::string& name, const Json& own, const Json& repriced) {
    const auto text = [](const Json& s, const char* side) { return sim::four_digit_text(s[side].get<double>()); };
    table.add_row({name, text(own, "nominal"), text(repriced, "low"), text(repriced, "nominal"), text(repriced, "high"),
                   percent_text(number_in(own, "/nominal"), number_in(repriced, "/nominal"))});
  };
  for (const auto& [block, s] : run.own["energy_by_block_mj"].items()) {
    row(block, s, run.repriced["energy_by_block_mj"][block]);
  }
  row("total", run.own["energy_mj"], run.repriced["energy_mj"]);
  for (const auto& [kind, s] : run.own["energy_by_kind_mj"].items()) {
    row("of it " + kind, s, run.repriced["energy_by_kind_mj"][kind]);
  }
  out += table.text();
  for (const auto& [name, pointer] : {std::pair{"W", "/power_w/nominal"},
                                      {"nJ per ray", "/perf/nj_per_ray"},
                                      {"frames/J GPU with memory", "/perf/frames_per_joule_gpu"},
                                      {"frames/J T&I alone", "/perf/frames_per_joule_tni"}}) {
    out += fmt::format("{} {}, by its own table {}\n", sim::four_digit_text(number_in(run.repriced, pointer)), name,
                       sim::four_digit_text(number_in(run.own, pointer)));
  }
  if (run.repriced.contains("power_at_fps_w")) {
    out += fmt::format("{} W at the target frame rate\n",
                       sim::four_digit_text(number_in(run.repriced, "/power_at_fps_w/nominal")));
  }
  return out + notes_text({run});
}

/// Columns of a table of sweep points, as paths in the result of energy_totals_json().
constexpr std::array kColumns = {"energy_mj.low",   "energy_mj.nominal",         "energy_mj.high",
                                 "power_w.nominal", "perf.frames_per_joule_gpu", "perf.frames_per_joule_tni"};

double total_at(const Json& totals, std::string path) {
  std::ranges::replace(path, '.', '/');
  return number_in(totals, ("/" + path).c_str());
}

std::vector<std::string> axes_of(const std::vector<RepricedRun>& runs) {
  std::vector<std::string> axes;
  for (const RepricedRun& run : runs) {
    for (const auto& [axis, value] : run.axes) {
      if (std::ranges::find(axes, axis) == axes.end()) axes.push_back(axis);
    }
  }
  return axes;
}

/// Returns the run's value on each axis of `axes`; empty for an axis that the run does not have.
std::vector<std::string> axis_cells(const RepricedRun& run, const std::vector<std::string>& axes) {
  std::vector<std::string> cells;
  for (const std::string& axis : axes) {
    const auto found = std::ranges::find(run.axes, axis, [](const auto& a) { return a.first; });
    cells.push_back(found == run.axes.end() ? "" : found->second);
  }
  return cells;
}

std::string points_text(const std::vector<RepricedRun>& points) {
  const std::vector<std::string> axes = axes_of(points);
  std::vector<std::string> header = {"n"};
  header.insert(header.end(), axes.begin(), axes.end());
  header.emplace_back("own energy_mj.nominal");
  header.insert(header.end(), kColumns.begin(), kColumns.end());
  sim::Table table(header);
  for (const RepricedRun& point : points) {
    std::vector<std::string> row = {point.n};
    for (const std::string& cell : axis_cells(point, axes)) row.push_back(sim::printable(cell));
    row.push_back(sim::four_digit_text(total_at(point.own, "energy_mj.nominal")));
    for (const char* path : kColumns) row.push_back(sim::four_digit_text(total_at(point.repriced, path)));
    table.add_row(std::move(row));
  }
  return fmt::format("{}\n{}\n{}{}", sim::printable(points.front().run, 1000), changes_text(points.front().changes),
                     table.text(), notes_text(points));
}

/// Formats energies for a terminal: a text for each run, a table for each sweep.
std::string priced_text(const std::vector<std::vector<RepricedRun>>& groups) {
  std::string out;
  for (const std::vector<RepricedRun>& group : groups) {
    out += out.empty() ? "" : "\n";
    out += group.front().n.empty() ? run_text(group.front()) : points_text(group);
  }
  return out;
}

/// Formats energies as CSV with one line per run and all digits of the numbers.
std::string priced_csv(const std::vector<RepricedRun>& runs) {
  const std::vector<std::string> axes = axes_of(runs);
  std::vector<std::string> header = {"run", "n"};
  header.insert(header.end(), axes.begin(), axes.end());
  header.emplace_back("own.totals.energy_mj.nominal");
  for (const char* path : kColumns) header.push_back(fmt::format("totals.{}", path));
  header.insert(header.end(), {"plays", "extrapolated"});
  std::string out = results::csv_line(header);
  for (const RepricedRun& run : runs) {
    std::vector<std::string> row = {run.run, run.n};
    std::ranges::move(axis_cells(run, axes), std::back_inserter(row));
    row.push_back(fmt::format("{}", total_at(run.own, "energy_mj.nominal")));
    for (const char* path : kColumns) row.push_back(fmt::format("{}", total_at(run.repriced, path)));
    row.push_back(fmt::format("{}", run.plays));
    row.push_back(fmt::format("{}", run.extrapolated.size()));
    out += results::csv_line(row);
  }
  return out;
}

/// Formats the energies of runs as JSON, schema raywatt-price/1.
std::string priced_json(const std::vector<RepricedRun>& runs) {
  Json out = {{"schema", "raywatt-price/1"}, {"runs", Json::array()}};
  for (const RepricedRun& run : runs) {
    Json entry = {{"run", run.n.empty() ? run.run : run.n}};
    if (!run.n.empty()) entry["sweep"] = run.run;
    entry.update({{"axes", Json::object()}, {"changes", Json::array()}});
    for (const auto& [axis, value] : run.axes) entry["axes"][axis] = value;
    for (const TableChange& c : run.changes) {
      entry["changes"].push_back({{"key", c.name}, {"from", c.from}, {"to", c.to}});
    }
    entry["own"] = run.own;
    entry["priced"] = run.repriced;
    entry["plays"] = run.plays;
    entry["extrapolated"] = run.extrapolated;
    out["runs"].push_back(std::move(entry));
  }
  return sim::json_lines(out);
}

std::map<std::string, sim::Band> table_values_of(RunConfig config) {
  std::map<std::string, sim::Band> out;
  for (const EnergyEntry& entry : energy_entries(config)) {
    for (const EnergyEntry::Figure& f : entry.figures) out[f.name] = f.band;
  }
  return out;
}

std::string band_text(const std::map<std::string, sim::Band>& values, const std::string& name) {
  const auto found = values.find(name);
  if (found == values.end()) return "none";
  const sim::Band& s = found->second;
  if (s.low == s.high) return fmt::format("{} without a band", s.nominal);
  return fmt::format("{} / {} / {}", s.low, s.nominal, s.high);
}

std::vector<TableChange> table_changes(const RunConfig& from, const RunConfig& to) {
  const auto a = table_values_of(from), b = table_values_of(to);
  auto all = a;
  all.insert(b.begin(), b.end());
  std::vector<TableChange> out;
  for (const auto& [name, value] : all) {
    TableChange change{name, band_text(a, name), band_text(b, name)};
    if (change.from != change.to) out.push_back(std::move(change));
  }
  const auto keys = sim::list_fields(from), others = sim::list_fields(to);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!keys[i].path.starts_with("power.") || keys[i].value == others[i].value) continue;
    const bool is_table = keys[i].kind == sim::FieldKind::kBandMap;
    out.push_back({keys[i].path, is_table ? "a table" : keys[i].value, is_table ? "another" : others[i].value});
  }
  return out;
}

/// Returns the energy totals of a run. With a target frame rate they include the power at that rate.
Json priced_totals(const PricedRun& run) {
  Json totals = energy_totals_json(run.energy(), run.work());
  if (const double fps = run.config().frame.fps; fps > 0) {
    sim::Band power;
    for (const sim::BandMember side : sim::kBandMembers)
      power.*side = fps * run.period_energy_pj(side) * kJoulesPerPicojoule;
    totals["power_at_fps_w"] = sim::band_json(power);
  }
  return totals;
}

RepricedRun price_run(const std::string& run, const ReportFile& report, const PriceTable& table) {
  const PricedRun own(report), repriced(report, table);
  return {.run = run,
          .own = priced_totals(own),
          .repriced = priced_totals(repriced),
          .changes = table_changes(own.config(), repriced.config()),
          .plays = std::max<std::size_t>(1, static_cast<std::size_t>(report.number("totals.replicates.count"))),
          .extrapolated = repriced.extrapolation_warnings()};
}

std::vector<RepricedRun> price_sweep(const fs::path& path, const PriceTable& table) {
  const auto folder = sweep::SweepFolder::open(path);
  const sweep::Store store = folder.store();
  std::vector<RepricedRun> out;
  results::StatusCounts counts;
  for (const sweep::Point& point : folder.read_points()) {
    const std::optional<std::string> report = store.read_report(point.id);
    ++counts[report ? sweep::PointStatus::kDone : results::listed_status(store, point.id)];
    if (!report) continue;
    out.push_back(price_run(path.string(), parse_report(*report, store.folder_of(point.id) / "report.json"), table));
    out.back().n = fmt::format("{}", point.n);
    out.back().axes = point.axes;
  }
  const std::string missing = results::missing_text(counts);
  if (out.empty()) throw sim::InputError(fmt::format("{}: {}", sim::printable(path.string()), missing));
  if (!missing.empty()) print_message("warning: {}: {}", sim::printable(path.string()), missing);
  return out;
}

}  // namespace

std::string price_text(const std::vector<fs::path>& paths, const PriceTable& table, PriceFormat format) {
  std::vector<std::vector<RepricedRun>> priced;
  std::error_code ignored;
  for (const fs::path& path : paths) {
    priced.push_back(fs::exists(path / "sweep.json", ignored)
                         ? price_sweep(path, table)
                         : std::vector<RepricedRun>{price_run(path.string(), load_report(path), table)});
  }
  if (format == PriceFormat::kText) return priced_text(priced);
  std::vector<RepricedRun> runs;
  for (std::vector<RepricedRun>& group : priced) std::ranges::move(group, std::back_inserter(runs));
  return format == PriceFormat::kJson ? priced_json(runs) : priced_csv(runs);
}

}  // namespace tools
