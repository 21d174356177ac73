#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_paths.h"
#include "tools/pricing/idle_machine.h"
#include "tools/run/run.h"
#include "tools/studies/compare/compare.h"

namespace tools {

void add_replicates(ReportFile& report, std::uint32_t count, std::uint32_t threads, Progress* progress) {
  if (report.number("totals.replicates.count") >= count) return;
  const auto refuse = [&](const std::string& why) {
    throw sim::InputError(fmt::format(
        "--replicates: {}: {}; allowed: reports of whole runs by this version's model, whose scene is where "
        "it was",
        sim::printable(report.file.string()), why));
  };
  if (report.json.value("partial", false)) refuse("is of a run that was interrupted");
  if (report.has("totals.sampled.tiles")) refuse("has estimates (--tile-sampling), and replicates play all tiles");
  if (report.has("totals.sliced.cycles.estimate"))
    refuse("has sums of slices (--slices), and replicates play all tiles");
  const auto program = report.json.find("program");
  if (program == report.json.end() || !program->is_string()) refuse("has no frame program");
  JobOptions options;
  options.program = program->get<std::string>();
  options.threads = threads;
  options.replicates = count;
  sim::Json played = plain_report(load_inputs(reported_config(report), threads, progress), options, progress);
  const auto cycles = played["totals"]["cycles"].get<double>();
  if (cycles != report.number("totals.cycles")) {
    refuse(fmt::format("says {:.0f} cycles, and played again it takes {:.0f}", report.number("totals.cycles"), cycles));
  }
  for (ReportNumber& number : report_numbers(played)) {
    if (number.path.starts_with("totals.replicates.")) report.numbers[std::move(number.path)] = number.value;
  }
  report.json["totals"]["replicates"] = std::move(played["totals"]["replicates"]);
}

}  // namespace tools
