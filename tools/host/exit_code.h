#pragma once

namespace tools {

/// Exit codes of the process.
enum ExitCode : int {
  kGood = 0,
  kCheckFailed = 1,
  kBadInput = 2,
  kStuckMachine = 3,
  kOurBug = 70,
  kIoFailed = 74,
};

}  // namespace tools
