#include "tools/studies/report/report.h"

#include <system_error>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/studies/compare/compare.h"
#include "tools/studies/report/page_data.h"
#include "tools/studies/report/page_file.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;

std::string page_of(const Bundle& bundle, const std::vector<fs::path>& inputs) {
  if (inputs.size() == 1 && is_sweep(inputs.front())) {
    sim::Json data = sweep_data(inputs.front());
    const std::string title = data["name"].get<std::string>();
    return page_html(bundle, "sweep", title, std::move(data));
  }
  std::vector<ReportFile> reports;
  for (const fs::path& path : inputs) {
    const std::string name = sim::printable(path.string());
    if (is_sweep(path)) {
      throw sim::InputError(fmt::format(
          "{}: is a sweep, which needs a page of its own; allowed: one sweep or search, or one or more runs", name));
    }
    std::error_code ignored;
    if (fs::is_directory(path, ignored) && !fs::exists(path / "report.json", ignored)) {
      throw sim::InputError(
          fmt::format("{}: holds no run, sweep or search: it has neither report.json nor sweep.json", name));
    }
    reports.push_back(load_report(path));
  }
  if (reports.size() == 1) return page_html(bundle, "run", run_title(reports[0]), run_data(reports[0]));
  const std::vector<std::string> names = short_names(reports);
  const std::string title =
      names.size() == 2 ? fmt::format("{} against {}", names[1], names[0]) : "Runs against " + names[0];
  return page_html(bundle, "diff", title, diff_data(reports));
}

}  // namespace

void write_report_page(const Options& options) {
  sim::check_output(options.out, {.mark = kPageMark, .kind = "page", .any = options.force});
  const Bundle bundle = load_bundle();
  sim::write_file_atomically(options.out, page_of(bundle, options.inputs));
}

}  // namespace tools::pages
