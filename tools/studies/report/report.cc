#include "tools/studies/report/report.h"

#include <system_error>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/studies/compare/compare.h"
#include "tools/studies/report/diff/diff_page.h"
#include "tools/studies/report/page/page_file.h"
#include "tools/studies/report/run/run_page.h"
#include "tools/studies/report/sweep/sweep_page.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;

std::string page_of(const Bundle& bundle, const std::vector<fs::path>& what) {
  if (what.size() == 1 && is_sweep(what.front())) {
    const View view = sweep_view(what.front());
    return page_html(bundle, "sweep", view.name(), {view});
  }
  std::vector<ReportFile> reports;
  for (const fs::path& path : what) {
    if (is_sweep(path)) {
      throw sim::InputError(
          fmt::format("{}: is a sweep, of which a page has one alone; allowed: one sweep or search, or "
                      "one or more runs",
                      sim::printable(path.string())));
    }
    std::error_code ignored;
    if (fs::is_directory(path, ignored) && !fs::exists(path / "report.json", ignored)) {
      throw sim::InputError(
          fmt::format("{}: holds no run, sweep or search: neither report.json nor sweep.json is there",
                      sim::printable(path.string())));
    }
    reports.push_back(load_report(path));
  }
  if (reports.size() == 1) return page_html(bundle, "run", run_title(reports[0]), {run_view(reports[0])});
  const std::vector<View> views = diff_views(reports);
  return page_html(bundle, "diff", views.size() == 1 ? views[0].name() : "Runs against " + short_names(reports)[0],
                   views);
}

}  // namespace

void write_report_page(const Options& options) {
  sim::check_output(options.out, {.mark = kPageMark, .kind = "page", .any = options.force});
  const Bundle bundle = load_bundle();
  sim::write_file_atomically(options.out, page_of(bundle, options.what));
}

}  // namespace tools::pages
