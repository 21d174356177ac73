#pragma once
#include <nlohmann/json.hpp>

#include "sim/io/json.h"

namespace fuzz {

/// Returns a small report.json that has every value the program reads from reports.
nlohmann::ordered_json seed_report();

}  // namespace fuzz
