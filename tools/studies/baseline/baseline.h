#pragma once
#include <cstdint>
#include <string>

namespace tools {

struct BaselineOptions {
  std::string suite;
  std::uint32_t jobs = 0;
  std::string junit;
  bool force = false;
  std::uint32_t replicates = 1;  ///< replicates of each run, to estimate noise
};

/// Simulates a regression suite and stores its values as the baseline. Returns kGood, or kCheckFailed without storing
/// if a run failed. Throws InputError if values are already stored, unless `force` is set.
int record_baseline(const BaselineOptions& options);
/// Simulates a regression suite and compares its values with the stored baseline. Returns kGood, or kCheckFailed if a
/// run failed or a value changed beyond its tolerance. Throws InputError if the stored values were measured on other
/// scenes or programs.
int check_baseline(const BaselineOptions& options);
/// Simulates a regression suite, prints the values that changed and stores the new ones as the baseline. Returns kGood,
/// or kCheckFailed without storing if a run failed.
int accept_baseline(const BaselineOptions& options);

}  // namespace tools
