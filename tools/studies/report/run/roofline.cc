#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/trv.h"
#include "sim/report/table.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

constexpr double kBeyond = 5;  ///< the axis goes on so many times beyond what is of interest

double share_of(const Run& run, std::string_view unit, std::initializer_list<const char*> reasons) {
  const std::string path = fmt::format("units.{}.", unit);
  const double elapsed = run.report.number(path + "elapsed");
  double cycles = 0;
  for (const char* reason : reasons) cycles += run.report.number(path + "why." + reason);
  return elapsed > 0 ? cycles / elapsed : 0;
}

}  // namespace

/// Ceilings are this frame's own: rays a second if only that resource counted, at this frame's bytes, steps and kernel
/// cycles a ray.
void add_roofline(const Run& run, View& view) {
  const double rays = run.number("totals.rays.total"), bytes = run.number("totals.dram_bytes"), seconds = run.seconds();
  const double bus = share_of(run, hw::DramChannel::kName, {"reading", "writing"});
  const double boxes = share_of(run, hw::Trv::kName, {"visiting"});
  const double array = share_of(run, hw::Srp::kName, {"running", "switching"});
  Section section(
      "roofline", "Roofline",
      "Rays per second against bytes of DRAM traffic per ray. Ceilings are what each resource would allow if it "
      "were busy at its peak all the time, with this frame's work per ray.");
  if (rays <= 0 || bytes <= 0 || seconds <= 0 || bus <= 0) {
    section.text("This run moved no bytes, or has no counters, so there is no roofline.");
    return view.add(section);
  }
  const double rate = rays / seconds, per_ray = bytes / rays, bandwidth = bytes / seconds / bus;
  Dataset data({{"name", "what"},
                {"x", "DRAM bytes per ray", Show::kSi, "B"},
                {"y", "rays per second", Show::kSi, "rays/s"},
                {"line", "ceiling"},
                {"label", "labelled"}});
  std::vector<std::pair<double, std::string>> ceilings;
  if (boxes > 0) ceilings.emplace_back(rate / boxes, "T&I units");
  if (array > 0) ceilings.emplace_back(rate / array, "shader cores");
  std::ranges::sort(ceilings, std::greater<>());
  const double most = ceilings.empty() ? rate : ceilings.front().first;
  const double least = ceilings.empty() ? rate : ceilings.back().first;
  const double low = std::min(per_ray, bandwidth / most) / kBeyond,
               high = std::max(per_ray, bandwidth / least) * kBeyond;
  const bool is_left = std::log(per_ray / low) < std::log(high / low) / 2;
  data.row({fmt::format("this run: {} at {} a ray", sim::si_text(rate, "rays/s"), sim::si_text(per_ray, "B")), per_ray,
            rate, "", is_left ? "right of point" : "left of point"});
  const auto line = [&](const std::string& words, double ceiling, double at_low, double at_high, const char* label) {
    const std::string name = fmt::format("{}: {}", words, sim::si_text(ceiling, words == "DRAM" ? "B/s" : "rays/s"));
    data.row({name, low, at_low, words, label});
    data.row({name, high, at_high, words, ""});
  };
  line("DRAM", bandwidth, bandwidth / low, bandwidth / high, "above");
  for (std::size_t i = 0; i < ceilings.size(); ++i)
    line(ceilings[i].second, ceilings[i].first, ceilings[i].first, ceilings[i].first, i == 0 ? "above" : "below");
  view.data("roofline", data);
  section.chart("roofline-chart", "Rays per second against bytes per ray",
                "This run below the ceilings of memory, T&I units and shader cores, on logarithmic axes", "roofline",
                {{"kind", "roofline"}});
  view.add(section);
}

}  // namespace tools::pages
