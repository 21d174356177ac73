#pragma once
#include <string>
#include <vector>

#include "hw_models/dram/dram_measurements.h"

namespace tools {

/// Reads the requests of a stream file, or of standard input if `file` is "-". A line is a hexadecimal address, R or W,
/// and optionally the earliest time in ns. Empty lines and comments after # are ignored. An InputError has file and
/// line.
std::vector<hw::DramRequest> load_dram_stream(const std::string& file);

}  // namespace tools
