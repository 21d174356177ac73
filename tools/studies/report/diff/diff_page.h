#pragma once
#include <vector>

#include "tools/analysis/report_file.h"
#include "tools/studies/report/page/page_model.h"

namespace tools::pages {

/// Each run but the first against the first, a view for each.
std::vector<View> diff_views(const std::vector<ReportFile>& reports);

}  // namespace tools::pages
