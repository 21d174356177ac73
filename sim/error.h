#pragma once
#include <stdexcept>
#include <string>

namespace sim {

/// Exception: the user's input cannot be used. The text contains the place (file, line, column, key), the problem and
/// what is allowed. The program exits with code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Exception: reading or writing failed because of a missing folder, a full disk or lost permission. The program exits
/// with code 74.
struct IoError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Exception: the simulated machine is stuck. Either work is left and no unit has a wake-up time, or units are active
/// and retire nothing. The program exits with code 3.
struct Deadlock : std::runtime_error {
  Deadlock(const std::string& what, std::string machine_state)
      : std::runtime_error(what), state(std::move(machine_state)) {}
  std::string state;  ///< state of the machine's units as text, one line per unit
};

/// Callback that a long computation polls. If it returns true, the computation throws Cancelled.
using Stop = bool (*)();

struct Cancelled {};

}  // namespace sim
