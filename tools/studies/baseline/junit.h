#pragma once
#include <filesystem>

#include "tools/studies/baseline/check.h"

namespace tools {

/// Writes a check as JUnit XML, which continuous integration systems show: a test case for each run. IoError.
void write_junit(const std::filesystem::path& file, const Suite& suite, const Checked& checked);

}  // namespace tools
