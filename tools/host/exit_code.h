#pragma once

namespace tools {

/// What the process ends with.
enum ExitCode : int {
  kGood = 0,
  kCheckFailed = 1,
  kBadInput = 2,
  kStuckMachine = 3,
  kOurBug = 70,
  kIoFailed = 74,
};

}  // namespace tools
