#pragma once
#include <string>
#include <vector>

#include "hw_models/dram/dram_measurements.h"

namespace tools {

/// The requests of a stream file, or of standard input if `file` is "-". A line is a hexadecimal address, R or W, and
/// if wanted the earliest time in ns; empty lines and what follows a # do not count. InputError names file and line.
std::vector<hw::DramRequest> load_dram_stream(const std::string& file);

}  // namespace tools
