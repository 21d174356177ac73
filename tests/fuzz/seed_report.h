#pragma once
#include <nlohmann/json.hpp>

#include "sim/report/report_json.h"

namespace fuzz {

/// A small report with everything that is read of one.
nlohmann::ordered_json seed_report();

}  // namespace fuzz
