#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>

namespace tools::results {

/// How many points are in which state.
struct Collected {
  std::size_t done = 0, failed = 0, missing = 0, damaged = 0;
  bool unchanged = false;  ///< nothing had happened since the last time, and nothing was written
  std::size_t points() const { return done + failed + missing + damaged; }
};

/// Makes index.sqlite and results.csv of a sweep anew from its points.jsonl and what the store holds of these points.
/// Both are replaced as a whole; another collector in the same folder waits. InputError if the folder holds no sweep.
Collected collect(const std::filesystem::path& sweep, const std::filesystem::path& store);

/// "200 points: 198 done, 2 failed"
std::string summary_text(const Collected& collected);

}  // namespace tools::results
