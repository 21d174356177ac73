#pragma once
#include <nlohmann/json.hpp>

#include "sim/report/report_json.h"

namespace fuzz {

/// Returns a small report with all values that readers use.
nlohmann::ordered_json seed_report();

}  // namespace fuzz
