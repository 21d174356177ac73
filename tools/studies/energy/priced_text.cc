#include "tools/studies/energy/priced_text.h"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/studies/sweep/results/table.h"

namespace tools {
namespace {

using sim::Json;

double at(const Json& totals, const char* pointer) { return totals.at(sim::JsonPointer(pointer)).get<double>(); }

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

/// Reasons to read the figures with care.
std::string notes_text(const std::vector<Priced>& runs) {
  std::set<std::size_t> plays;
  std::set<std::string> extrapolated;
  for (const Priced& run : runs) {
    if (run.plays > 1) plays.insert(run.plays);
    extrapolated.insert(run.extrapolated.begin(), run.extrapolated.end());
  }
  std::string out;
  if (!plays.empty()) out += fmt::format("priced is the first of {} plays\n", fmt::join(plays, " or "));
  for (const std::string& line : extrapolated) out += fmt::format("note: {}\n", line);
  return out;
}

std::string run_text(const Priced& run) {
  std::string out = fmt::format("{}\n{}\n", sim::printable(run.run, 1000), changes_text(run.changes));
  sim::Table table({"mJ", "own nominal", "low", "nominal", "high", ""});
  const auto row = [&](const std::string& name, const Json& own, const Json& asked) {
    const auto text = [](const Json& s, const char* side) { return sim::four_digits(s[side].get<double>()); };
    table.add_row({name, text(own, "nominal"), text(asked, "low"), text(asked, "nominal"), text(asked, "high"),
                   percent(at(own, "/nominal"), at(asked, "/nominal"))});
  };
  for (const auto& [block, s] : run.own["energy_by_block_mj"].items()) {
    row(block, s, run.asked["energy_by_block_mj"][block]);
  }
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
  return out + notes_text({run});
}

/// Figures of a table of runs, by their path among the totals.
constexpr std::array kColumns = {"energy_mj.low",   "energy_mj.nominal",         "energy_mj.high",
                                 "power_w.nominal", "perf.frames_per_joule_gpu", "perf.frames_per_joule_tni"};

double figure(const Json& totals, std::string path) {
  std::ranges::replace(path, '.', '/');
  return at(totals, ("/" + path).c_str());
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

/// Values of a run's axes, empty for those that it has not.
std::vector<std::string> axis_cells(const Priced& run, const std::vector<std::string>& axes) {
  std::vector<std::string> cells;
  for (const std::string& axis : axes) {
    const auto found = std::ranges::find(run.axes, axis, [](const auto& a) { return a.first; });
    cells.push_back(found == run.axes.end() ? "" : found->second);
  }
  return cells;
}

std::string points_text(const std::vector<Priced>& points) {
  const std::vector<std::string> axes = axes_of(points);
  std::vector<std::string> header = {"n"};
  header.insert(header.end(), axes.begin(), axes.end());
  header.emplace_back("own energy_mj.nominal");
  header.insert(header.end(), kColumns.begin(), kColumns.end());
  sim::Table table(header);
  for (const Priced& point : points) {
    std::vector<std::string> row = {point.n};
    for (const std::string& cell : axis_cells(point, axes)) row.push_back(sim::printable(cell));
    row.push_back(sim::four_digits(figure(point.own, "energy_mj.nominal")));
    for (const char* path : kColumns) row.push_back(sim::four_digits(figure(point.asked, path)));
    table.add_row(std::move(row));
  }
  return fmt::format("{}\n{}\n{}{}", sim::printable(points.front().run, 1000), changes_text(points.front().changes),
                     table.text(), notes_text(points));
}

}  // namespace

std::string priced_text(const std::vector<std::vector<Priced>>& groups) {
  std::string out;
  for (const std::vector<Priced>& group : groups) {
    out += out.empty() ? "" : "\n";
    out += group.front().n.empty() ? run_text(group.front()) : points_text(group);
  }
  return out;
}

std::string priced_csv(const std::vector<Priced>& runs) {
  const std::vector<std::string> axes = axes_of(runs);
  std::vector<std::string> header = {"run", "n"};
  header.insert(header.end(), axes.begin(), axes.end());
  header.emplace_back("own.totals.energy_mj.nominal");
  for (const char* path : kColumns) header.push_back(fmt::format("totals.{}", path));
  header.insert(header.end(), {"plays", "extrapolated"});
  std::string out = results::csv_line(header);
  for (const Priced& run : runs) {
    std::vector<std::string> row = {run.run, run.n};
    std::ranges::move(axis_cells(run, axes), std::back_inserter(row));
    row.push_back(fmt::format("{}", figure(run.own, "energy_mj.nominal")));
    for (const char* path : kColumns) row.push_back(fmt::format("{}", figure(run.asked, path)));
    row.push_back(fmt::format("{}", run.plays));
    row.push_back(fmt::format("{}", run.extrapolated.size()));
    out += results::csv_line(row);
  }
  return out;
}

std::string priced_json(const std::vector<Priced>& runs) {
  Json out = {{"schema", "raywatt-price/1"}, {"runs", Json::array()}};
  for (const Priced& run : runs) {
    Json entry = {{"run", run.n.empty() ? run.run : run.n}};
    if (!run.n.empty()) entry["sweep"] = run.run;
    entry.update({{"axes", Json::object()}, {"changes", Json::array()}});
    for (const auto& [axis, value] : run.axes) entry["axes"][axis] = value;
    for (const FigureChange& c : run.changes) {
      entry["changes"].push_back({{"key", c.name}, {"from", c.from}, {"to", c.to}});
    }
    entry["own"] = run.own;
    entry["priced"] = run.asked;
    entry["plays"] = run.plays;
    entry["extrapolated"] = run.extrapolated;
    out["runs"].push_back(std::move(entry));
  }
  return sim::json_text(out);
}

}  // namespace tools
