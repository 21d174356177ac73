#include <fmt/format.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/frame/dma.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/ray_dispatcher.h"
#include "hw_models/tni/trv.h"
#include "sim/report/table.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

using sim::si_text;

/// A pipeline, an array or a bus: which cycles of a unit it is at its peak in, and what it then does.
struct Peak {
  std::string words;
  std::string unit;                  ///< kind of unit
  std::vector<const char*> at_peak;  ///< reasons
  std::vector<const char*> work;     ///< counters of what passes then
  const char* each;                  ///< what it counts
};

std::vector<Peak> peaks() {
  return {
      {"Traversal units: box pipes", std::string(hw::Trv::kName), {"visiting"}, {"visits"}, "nodes"},
      {"Intersection units: triangle pipes", std::string(hw::Ist::kName), {"testing"}, {"tests"}, "triangles"},
      {"Ray dispatchers", std::string(hw::RayDispatcher::kName), {"dispatching"}, {"rays_in"}, "rays"},
      {"Shader cores: arrays", std::string(hw::Srp::kName), {"running"}, {"items"}, "items"},
      {"Core ports to the L2", std::string(hw::CorePort::kCachePort), {"line"}, {"lines_down", "lines_up"}, "lines"},
      {"Core ports of the DMA", std::string(hw::CorePort::kDmaPort), {"line"}, {"lines_down", "lines_up"}, "lines"},
      {"DMA", std::string(hw::Dma::kName), {"moving"}, {"lines_written", "lines_read"}, "lines"},
      {"L2 banks", std::string(hw::L2Bank::kName), {"serving"}, {"reads", "writes"}, "look-ups"},
      {"DRAM data buses", std::string(hw::DramChannel::kName), {"reading", "writing"}, {"bytes"}, "B"}};
}

}  // namespace

void add_units(const Run& run, View& view) {
  Section section(
      "units", "Units, in percent of their peak",
      "The share of its cycles in which a unit did all that it can do. What kept it from more is below, by unit.");
  Dataset data({{"unit", "unit"},
                {"share", "of its peak", Show::kPercent},
                {"rate", "rate", Show::kSi},
                {"each", "of"},
                {"units", "units", Show::kNumber},
                {"label", "shown"}});
  for (const Peak& peak : peaks()) {
    const std::string path = fmt::format("units.{}.", peak.unit);
    const double elapsed = run.report.number(path + "elapsed");
    if (elapsed == 0) continue;
    const auto sum = [&](const char* of, const std::vector<const char*>& names) {
      double all = 0;
      for (const char* name : names) all += run.report.number(path + of + name);
      return all;
    };
    const double share = sum("why.", peak.at_peak) / elapsed, seconds = run.seconds();
    const double rate = seconds > 0 ? sum("counters.", peak.work) / seconds : 0;
    const bool is_bytes = std::string_view(peak.each) == "B";
    std::string label = percent_text(share);
    if (rate > 0 && share > 0) {
      const std::string unit = is_bytes ? "B/s" : "", each = is_bytes ? "" : fmt::format(" {}/s", peak.each);
      label += fmt::format(", {}{}, {} when busy", si_text(rate, unit), each, si_text(rate / share, unit));
    }
    data.row({peak.words, share, rate, peak.each, run.report.number(path + "units"), label});
  }
  if (data.empty()) {
    section.text("This report has no counters.");
    return view.add(section);
  }
  view.data("peaks", data);
  section.chart("peaks", "Busy at their peak",
                "Share of the cycles of each kind of unit in which it worked at its peak rate", "peaks",
                {{"kind", "bars"},
                 {"name", "unit"},
                 {"value", "share"},
                 {"title", "of the unit's peak"},
                 {"format", ".0%"},
                 {"label", "label"},
                 {"domain", {0, 1}}});
  view.add(section);
}

}  // namespace tools::pages
