#pragma once
#include <filesystem>

#include "tools/studies/report/page/page_model.h"

namespace tools::pages {

/// Is this the folder of a sweep or a search?
bool is_sweep(const std::filesystem::path& folder);

/// All that a page shows of a sweep or a search, from what has come out until now.
View sweep_view(const std::filesystem::path& folder);

}  // namespace tools::pages
