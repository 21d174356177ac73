#pragma once
#include <filesystem>
#include <stdexcept>

#include "tests/tools/program.h"

namespace test {

/// Simulates 32 x 16 pixels with results in the folder `out`, and returns that folder.
inline std::filesystem::path simulate_into_folder(const std::filesystem::path& out, const Words& more = {}) {
  Words words = {"run",          "--quiet", "--threads", "1", "-o", out.string(), "--set", "scene.triangles=500",
                 "--resolution", "32x16"};
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  if (ending.exit != 0) throw std::runtime_error(ending.err);
  return out;
}

}  // namespace test
