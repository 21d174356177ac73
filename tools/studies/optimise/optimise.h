#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tools/studies/sweep/launch/launcher.h"

namespace tools::optimise {

/// A search by its file, and what replaces the file's own.
struct Options : LauncherOptions {
  std::filesystem::path file, out, store;
  std::optional<std::uint64_t> budget, seed;
  std::string fidelity;
  bool quiet = false;
  std::string progress = "auto";
};

/// Searches, and writes history.jsonl and front.csv: kGood, or kCheckFailed if nothing is feasible or points failed.
int run(const Options& options);

}  // namespace tools::optimise
