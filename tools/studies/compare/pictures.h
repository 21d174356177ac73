#pragma once
#include <filesystem>

#include "tools/studies/compare/compare.h"

namespace tools {

/// Compares the first frame's pictures of two run folders, linear floats if both have them and else 8 bits, and writes
/// down the mean squared difference of their sRGB values, or why there is none.
void compare_pictures(const std::filesystem::path& a, const std::filesystem::path& b, Comparison& out);

}  // namespace tools
