#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "tools/analysis/report_file.h"
#include "tools/pricing/priced_run.h"
#include "tools/studies/report/page/page_model.h"

namespace tools::pages {

/// A run, as the parts of its page read it.
struct Run {
  const ReportFile& report;
  std::filesystem::path folder;       ///< where its pictures are
  std::unique_ptr<PricedRun> priced;  ///< none if its counts do not come to its energy here
  std::string not_priced;             ///< why

  const Json& totals() const { return at(report.json, {"totals"}); }
  double number(const char* path) const { return report.number(path); }
  double seconds() const { return number("totals.time_ms") / 1e3; }
};

// Each adds a section, its data, or what stands above the sections.
void add_verdict(const Run& run, View& view);
void add_headlines(const Run& run, View& view);
void add_pictures(const Run& run, View& view);
void add_series(const Run& run, View& view);
void add_units(const Run& run, View& view);
void add_cycles(const Run& run, View& view);
void add_energy(const Run& run, View& view);
void add_kernels(const Run& run, View& view);
void add_memory(const Run& run, View& view);
void add_roofline(const Run& run, View& view);
void add_frames(const Run& run, View& view);
void add_origin(const Run& run, View& view);

}  // namespace tools::pages
