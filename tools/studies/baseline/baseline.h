#pragma once
#include <cstdint>
#include <string>

namespace tools {

struct BaselineOptions {
  std::string suite;
  std::uint32_t jobs = 0;
  std::string junit;
  bool force = false;
  std::uint32_t replicates = 1;  ///< replicates of each run
};

// Each simulates the suite and returns kGood, or kCheckFailed if a run failed or a value moved. Throws InputError if
// the stored values belong to other inputs.
int record_baseline(const BaselineOptions& options);
int check_baseline(const BaselineOptions& options);
int accept_baseline(const BaselineOptions& options);

}  // namespace tools
