#pragma once
#include <filesystem>

namespace fuzz {

/// Reads a trace file as `raywatt trace info` and `raywatt trace replay` do, but simulates no machine.
void read_trace(const std::filesystem::path& file);

}  // namespace fuzz
