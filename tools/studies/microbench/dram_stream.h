#pragma once
#include <string>
#include <vector>

#include "hw_models/dram/dram_measurements.h"

namespace tools {

/// Reads DRAM requests from a text file, or from standard input if `file` is "-". A line has a hexadecimal address, R
/// (read) or W (write), and optionally the earliest time of the request in ns. Empty lines and # comments are ignored.
/// Throws InputError with file and line.
std::vector<hw::DramRequest> load_dram_stream(const std::string& file);

}  // namespace tools
