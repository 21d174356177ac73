#include "tools/pricing/rated_report.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/analysis/rate_report.h"
#include "tools/analysis/report_file.h"
#include "tools/pricing/priced_run.h"
#include "tools/pricing/reported_units.h"
#include "tools/run/frame/machine_run.h"

namespace tools {
namespace {

/// Removes a number or a group from a report's totals.
void remove_total(ReportFile& report, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  std::string group = dot == std::string::npos ? "" : "/" + name.substr(0, dot);
  std::ranges::replace(group, '.', '/');
  const sim::JsonPointer at("/totals" + group);
  if (report.json.contains(at)) report.json[at].erase(name.substr(dot + 1));
  const std::string path = "totals." + name;
  std::erase_if(report.numbers,
                [&](const auto& number) { return number.first == path || number.first.starts_with(path + "."); });
}

}  // namespace

FrameRate evaluate_report_rate(const ReportFile& report, double fps) {
  const PricedRun run(report);
  RunConfig config = run.config();
  config.frame.fps = fps;
  const sim::EnergyReport energy = run.energy();
  const std::vector<sim::UnitReport> units =
      idle_unit_reports(*config.gpu, ReportedCounts(report).optional_units(), config.bvh);
  const double mean_ms = run.work().time_ms / run.work().frames;
  double slowest_ms = 0;
  for (int i = 0; i < static_cast<int>(run.work().frames); ++i) {
    slowest_ms = std::max(slowest_ms, report.number(fmt::format("frames[{}].time_ms", i)));
  }
  return evaluate_frame_rate(config, {.energy = energy,
                                      .units = units,
                                      .count = run.work().frames,
                                      .time_ms = run.work().time_ms,
                                      .slowest_ms = slowest_ms > 0 ? slowest_ms : mean_ms});
}

void set_frame_rate(ReportFile& report, double fps) {
  sim::Json rated = frame_rate_json(evaluate_report_rate(report, fps));
  for (ReportNumber& number : report_numbers({{"totals", rated}}))
    report.numbers[std::move(number.path)] = number.value;
  std::vector<std::string> stale = {"replicates.figures.fps_margin", "replicates.figures.power_at_fps_w"};
  if (report.number("config.frame.fps") != fps) {
    for (const char* metric : {"sustained_fps", "stability", "sustained"}) {
      stale.push_back(metric);
      stale.push_back(fmt::format("replicates.figures.{}", metric));
    }
  }
  for (const std::string& metric : stale) remove_total(report, metric);
  report.json["totals"].update(rated);
}

}  // namespace tools
