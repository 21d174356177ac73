#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "hw_models/memory/unit_names.h"
#include "sim/error.h"
#include "tools/host/standard_streams.h"
#include "tools/intervals/run_intervals.h"
#include "tools/studies/report/page/colours.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

constexpr std::size_t kMostIntervals = 512;

/// A group of series, and how it is drawn.
struct Group {
  const char *name, *words, *about;
  bool stacked;
};

constexpr std::array<Group, 11> kGroups = {
    {{"power", "Power by block", "power of each block of the GPU over time", true},
     {"power_by_kind", "Power by kind", "dynamic, clock and leakage power over time", true},
     {"bandwidth", "Bandwidth", "bandwidth of memory and of the L2 over time", false},
     {"hit_rate", "Hit rates", "hit rates of caches over time", false},
     {"utilisation", "Utilisation", "utilisation of T&I units, shader cores and memory over time", false},
     {"stack.srp", "Cycles of the shader cores", "shares of the shader cores' cycles by reason over time", true},
     {"stack.tni", "Cycles of the traversal units", "shares of the traversal units' cycles by reason over time", true},
     {"stack.ist", "Cycles of the intersection units", "shares of the intersection units' cycles by reason over time",
      true},
     {"stack.dram", "Cycles of the memory channels", "shares of the channels' cycles by reason over time", true},
     {"rays", "Rays traced", "rays traced per second over time", false},
     {"rays_in_flight", "Rays in flight", "rays inside the T&I units over time", false}}};

Json five_digits(double value) {
  if (!std::isfinite(value)) return {};
  const double scale = value == 0 ? 1 : std::pow(10.0, 4 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

bool is_nothing(const IntervalSeries& series) {
  return std::ranges::all_of(series.values, [](double value) { return value == 0 || !std::isfinite(value); });
}

/// Series of a group as columns; those that are nothing all along are left out.
std::vector<const IntervalSeries*> members(const IntervalTable& table, const Group& group) {
  std::vector<const IntervalSeries*> found;
  for (const IntervalSeries& series : table.series) {
    const bool is_sum = group.stacked && series.name == "total";
    if (series.group == group.name && !is_sum && !is_nothing(series)) found.push_back(&series);
  }
  return found;
}

/// Each name's colour if all are blocks of the GPU, else none.
Json block_colours(const std::vector<std::string>& names) {
  constexpr auto kNames = hw::names_of(hw::Block{});
  Json found = Json::array();
  for (const std::string& name : names) {
    const auto at = static_cast<std::size_t>(std::ranges::find(kNames, name) - kNames.begin());
    if (at == kNames.size()) return Json::array();
    found.push_back(Json::array({name, colours::kBlocks.at(at)}));
  }
  return found;
}

void add_group(const IntervalTable& table, const Group& group, View& view, Json& charts) {
  const std::vector<const IntervalSeries*> series = members(table, group);
  if (series.empty()) return;
  const std::string& unit = series.front()->unit;
  std::vector<Column> columns = {{"begin_us", "from", Show::kNumber, "us"}, {"end_us", "to", Show::kNumber, "us"}};
  std::vector<std::string> names;
  for (const IntervalSeries* each : series) {
    columns.push_back({each->name, each->name, Show::kNumber, unit});
    names.push_back(each->name);
  }
  Dataset data(columns);
  for (std::size_t i = 0; i < table.begin_us.size(); ++i) {
    std::vector<Json> row = {five_digits(table.begin_us[i]), five_digits(table.end_us[i])};
    for (const IntervalSeries* each : series) row.push_back(five_digits(each->values[i]));
    data.row(std::move(row));
  }
  const std::string name = fmt::format("series {}", group.name);
  view.data(name, data);
  charts.push_back({{"id", group.name},
                    {"name", group.words},
                    {"about", group.about},
                    {"data", name},
                    {"chart",
                     {{"kind", "series"},
                      {"names", names},
                      {"unit", unit},
                      {"stacked", group.stacked},
                      {"colours", block_colours(names)}}}});
}

}  // namespace

void add_series(const Run& run, View& view) {
  Section section(
      "time", "Over time",
      "Brush a stretch of time, and the picture above shows the tiles that were in flight in it; point at a "
      "tile, and its time is marked here.");
  if (!RunIntervals::are_beside(run.report)) {
    section.text("This run kept no intervals of time.");
    return view.add(section);
  }
  try {
    const RunIntervals intervals(run.report);
    if (intervals.frames().empty()) throw sim::InputError("its file of intervals is empty");
    const IntervalTable table = derive(intervals, intervals.frames().front(), &sim::Band::nominal, kMostIntervals);
    Json charts = Json::array();
    for (const Group& group : kGroups) add_group(table, group, view, charts);
    if (charts.empty()) throw sim::InputError("nothing happened in any interval");
    if (intervals.frames().size() > 1) section.text("Of the first frame.");
    section.block("series", "series", "Over time", {{"charts", std::move(charts)}});
  } catch (const sim::InputError& error) {
    section.text(fmt::format("Figures over time are not shown: {}", error.what()));
    print_message("warning: {}; the page shows no figures over time", error.what());
  }
  view.add(section);
}

}  // namespace tools::pages
