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

FrameRate evaluate_report_rate(const ReportFile& report, double fps) {
  const PricedRun run(report);
  RunConfig config = run.config();
  config.frame.fps = fps;
  const sim::EnergyReport energy = run.energy();
  const std::vector<sim::UnitReport> units =
      idle_unit_reports(*config.gpu, ReportedCounts(report).has_rasteriser(), config.bvh);
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
  if (const sim::JsonPointer figures("/totals/replicates/figures"); report.json.contains(figures)) {
    for (const char* metric : {"fps_margin", "power_at_fps_w"}) report.json[figures].erase(metric);
  }
  std::erase_if(report.numbers, [](const auto& number) {
    return number.first.starts_with("totals.replicates.figures.fps_margin") ||
           number.first.starts_with("totals.replicates.figures.power_at_fps_w");
  });
  report.json["totals"].update(rated);
}

}  // namespace tools
