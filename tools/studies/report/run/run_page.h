#pragma once
#include "tools/analysis/report_file.h"
#include "tools/studies/report/page/page_model.h"

namespace tools::pages {

/// "chess, 1024x512, full:1"
std::string run_title(const ReportFile& report);

/// All that a page shows of a run.
View run_view(const ReportFile& report);

}  // namespace tools::pages
