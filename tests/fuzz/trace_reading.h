#pragma once
#include <filesystem>

namespace fuzz {

/// Reads a trace as `raywatt trace info` and `raywatt trace replay sgrt-2016 FILE` do, without a machine.
void read_trace(const std::filesystem::path& file);

}  // namespace fuzz
