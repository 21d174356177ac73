#include <array>
#include <map>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/unit_kinds.h"
#include "sim/io/printable.h"
#include "tools/studies/report/page/colours.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

/// A part of totals.top_down: where it stands, its words, its colour.
struct Part {
  const char* group;
  const char* level;  ///< level of a miss; empty: the part itself
  const char* words;
  const char* colour;
  bool pale;
  const char* meaning;
};

constexpr std::array<Part, 18> kParts = {{
    {"kernels", "", "kernels", colours::kWork, false, "a kernel's loop ran on the array"},
    {"switches", "", "kernel switches", colours::kWorkMiddle, true, "the array was configured for another kernel"},
    {"banks", "", "tile-buffer banks", colours::kWorkLight, true, "accesses met in a bank of the tile buffer"},
    {"data_misses", "interconnect", "data-cache misses: interconnect", colours::kWaitLight, true,
     "the array stood still for a line of the data cache, on its way between core and L2"},
    {"data_misses", "l2", "data-cache misses: L2", colours::kWaitMiddle, true, "the same, inside the L2"},
    {"data_misses", "dram", "data-cache misses: DRAM", colours::kWait, false, "the same, in memory"},
    {"boxes", "", "box tests", colours::kTrace, false, "the array waited for rays, traversal units tested nodes"},
    {"triangles", "", "triangle tests", colours::kTraceMiddle, true,
     "the array waited for rays, triangles were tested"},
    {"pipes", "", "T&I pipelines", colours::kTraceLight, true, "too few rays to fill the pipelines of the T&I unit"},
    {"tree_misses", "interconnect", "tree misses: interconnect", colours::kTreeLight, true,
     "rays waited for a line of nodes or triangles, on its way between core and L2"},
    {"tree_misses", "l2", "tree misses: L2", colours::kTreeMiddle, true, "the same, inside the L2"},
    {"tree_misses", "dram", "tree misses: DRAM", colours::kTree, false, "the same, in memory"},
    {"raster", "", "rasteriser", colours::kRasterWork, false, "no ray was out, the core's rasteriser worked"},
    {"raster_misses", "interconnect", "rasteriser's misses: interconnect", colours::kRasterLight, true,
     "the same, and it waited for a line or to write one, on its way between core and L2"},
    {"raster_misses", "l2", "rasteriser's misses: L2", colours::kRasterMiddle, true, "the same, inside the L2"},
    {"raster_misses", "dram", "rasteriser's misses: DRAM", colours::kRaster, false, "the same, in memory"},
    {"transfers", "", "transfers", colours::kRest, false, "no ray was out, launches waited for the DMA"},
    {"no_tile", "", "no tile", colours::kRestLight, true, "the core had no tile"},
}};

double share_of(const Part& part, const Json& time) {
  return part.level[0] == '\0' ? number_at(time, {part.group}) : number_at(time, {part.group, part.level});
}

/// The parts that a run's cores may have: a machine without rasterisers has none of theirs.
std::vector<Part> parts_of(const Run& run) {
  std::vector<Part> parts;
  for (const Part& part : kParts) {
    const bool is_here = share_of(part, at(run.totals(), {"top_down", "gpu"})) > 0 ||
                         share_of(part, at(run.totals(), {"reference", "top_down"})) > 0;
    if (is_here || !std::string_view(part.group).starts_with("raster")) parts.push_back(part);
  }
  return parts;
}

void add_stack(const std::string& name, const Json& time, const std::vector<Part>& parts, Dataset& data) {
  int order = 0;
  for (const Part& part : parts) data.row({name, part.words, share_of(part, time), order++, part.pale, part.meaning});
}

Dataset stacks_of(const Run& run, const std::vector<Part>& parts) {
  Dataset data({{"who", "core"},
                {"part", "part"},
                {"share", "share of time", Show::kPercent},
                {"order", "order", Show::kNumber},
                {"pale", "pale"},
                {"meaning", "meaning"}});
  add_stack("all cores", at(run.totals(), {"top_down", "gpu"}), parts, data);
  if (const Json& cores = at(run.totals(), {"top_down", "cores"}); cores.is_array() && cores.size() > 1) {
    for (std::size_t i = 0; i < cores.size(); ++i) add_stack(fmt::format("core {}", i), cores[i], parts, data);
  }
  if (const Json& reference = at(run.totals(), {"reference", "top_down"}); reference.is_object())
    add_stack("reference program", reference, parts, data);
  return data;
}

constexpr std::array<const char*, 4> kKinds = {"working", "waiting", "idle", "background"};
constexpr std::array<const char*, 4> kKindMeanings = {"own work, or the time that own pipelines take",
                                                      "for another unit", "nothing to do, the clock is gated",
                                                      "time alone brings it, such as refresh"};

/// Sums of every kind of units and reason, in T&I terms of shares.
void add_reasons(const Run& run, View& view) {
  Dataset reasons({{"unit", "unit"},
                   {"reason", "reason"},
                   {"kind", "kind"},
                   {"share", "share of its cycles", Show::kPercent},
                   {"meaning", "meaning"}});
  Dataset kinds({{"unit", "unit"},
                 {"kind", "kind"},
                 {"share", "share of its cycles", Show::kPercent},
                 {"order", "order", Show::kNumber},
                 {"pale", "pale"},
                 {"meaning", "meaning"}});
  for (const hw::UnitKind& unit : hw::kUnitKinds) {
    const std::string path = fmt::format("units.{}.", unit.name);
    const double elapsed = run.report.number(path + "elapsed");
    if (elapsed == 0) continue;
    std::array<double, 4> by_kind{};
    for (const sim::Reason& reason : unit.reasons) {
      const double share = run.report.number(fmt::format("{}why.{}", path, reason.name)) / elapsed;
      const auto kind = static_cast<std::size_t>(reason.kind);
      by_kind.at(kind) += share;
      if (share > 0) reasons.row({unit.name, reason.name, kKinds.at(kind), share, reason.meaning});
    }
    for (std::size_t k = 0; k < kKinds.size(); ++k)
      kinds.row({unit.name, kKinds.at(k), by_kind.at(k), k, k >= 1, kKindMeanings.at(k)});
  }
  view.data("reasons", reasons);
  view.data("kinds", kinds);
}

/// Options of a chart of one column over the frames.
Json frame_line(const char* column, const char* unit) {
  return {{"kind", "lines"}, {"x", "frame"}, {"xTitle", "frame"}, {"xFormat", "d"}, {"y", column}, {"yTitle", unit}};
}

}  // namespace

void add_cycles(const Run& run, View& view) {
  Section section(
      "cycles", "Where the cycles went",
      "Every cycle of a core is in one part, seen from its shader core: blue, the array was busy; orange, it "
      "stood still for data; green and purple, it waited while rays were traced; olive and red, while the rasteriser "
      "worked; grey, there was nothing to do.");
  if (!at(run.totals(), {"top_down", "gpu"}).is_object()) {
    section.text("This report does not say.");
    return view.add(section);
  }
  const std::vector<Part> parts = parts_of(run);
  view.data("stacks", stacks_of(run, parts));
  Json colours = Json::array();
  for (const Part& part : parts) colours.push_back(Json::array({part.words, part.colour}));
  section.chart("stacks", "Cycle stacks of the cores", "Shares of each core's time by what it went to", "stacks",
                {{"kind", "stack"},
                 {"name", "who"},
                 {"nameTitle", "core"},
                 {"part", "part"},
                 {"share", "share"},
                 {"colours", std::move(colours)}});
  section.chart("bounds", "What each resource would be worth, made ideal",
                "Estimated speed-up of the frame for each resource made ideal, one at a time", "bounds",
                {{"kind", "bars"},
                 {"name", "resource"},
                 {"value", "speedup"},
                 {"title", "times as fast"},
                 {"label", "label"},
                 {"from", 1}});
  add_reasons(run, view);
  section.chart(
      "kinds", "Cycles of every unit by kind",
      "Shares of the cycles of each kind of unit: working, waiting, idle, background", "kinds",
      {{"kind", "stack"},
       {"name", "unit"},
       {"part", "kind"},
       {"share", "share"},
       {"colours",
        Json::array({Json::array({"working", colours::kWork}), Json::array({"waiting", colours::kWaitMiddle}),
                     Json::array({"idle", colours::kRestLight}), Json::array({"background", colours::kTraceLight})})}});
  section.table("reasons", "Every reason of every unit", "reasons");
  view.add(section);
}

void add_frames(const Run& run, View& view) {
  const Json& frames = at(run.report.json, {"frames"});
  if (!frames.is_array() || frames.size() < 2) return;
  Dataset data({{"frame", "frame", Show::kNumber},
                {"time_ms", "time", Show::kNumber, "ms"},
                {"energy_mj", "energy", Show::kNumber, "mJ"},
                {"rays", "rays", Show::kSi},
                {"limiter", "limited by"}});
  for (const Json& frame : frames) {
    data.row({at(frame, {"frame"}), at(frame, {"time_ms"}), at(frame, {"energy_mj", "nominal"}),
              at(frame, {"rays", "total"}), text_at(frame, {"limiter"})});
  }
  view.data("frames", data);
  Section section("frames", "Frames", "Figures above are sums and means of all frames.");
  section.chart("frame-times", "Time of each frame", "Time of each frame in milliseconds", "frames",
                frame_line("time_ms", "ms"));
  section.chart("frame-energies", "Energy of each frame", "Nominal energy of each frame in millijoules", "frames",
                frame_line("energy_mj", "mJ"));
  view.add(section);
}

}  // namespace tools::pages
