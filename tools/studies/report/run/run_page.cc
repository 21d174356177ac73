#include "tools/studies/report/run/run_page.h"

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

Run read(const ReportFile& report) {
  Run run{report, report.file.parent_path(), nullptr, {}};
  try {
    run.priced = std::make_unique<PricedRun>(report);
  } catch (const sim::InputError& error) {
    run.not_priced = error.what();
  }
  return run;
}

}  // namespace

std::string run_title(const ReportFile& report) {
  return fmt::format("{}, {}x{}, {}", text_at(report.json, {"scene", "name"}), report.number("resolution[0]"),
                     report.number("resolution[1]"), text_at(report.json, {"program"}));
}

View run_view(const ReportFile& report) {
  const Run run = read(report);
  View view(run_title(report));
  add_verdict(run, view);
  add_headlines(run, view);
  add_pictures(run, view);
  add_series(run, view);
  add_units(run, view);
  add_cycles(run, view);
  add_energy(run, view);
  add_kernels(run, view);
  add_memory(run, view);
  add_roofline(run, view);
  add_frames(run, view);
  add_origin(run, view);
  return view;
}

}  // namespace tools::pages
