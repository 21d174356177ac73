#pragma once
#include <stdexcept>
#include <string>

namespace sim {

/// The user's input cannot be used. The text names the place (file, line, column, key), the fault and what is allowed.
/// Exit code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reading or writing failed: missing folder, full disk, lost permission. Exit code 74.
struct IoError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The machine is stuck: work is left, but no unit has a wake-up time, or units are active and retire nothing. Exit
/// code 3.
struct Deadlock : std::runtime_error {
  Deadlock(const std::string& what, std::string machine_state)
      : std::runtime_error(what), state(std::move(machine_state)) {}
  std::string state;  ///< one line per unit
};

/// Polled by long computations, which throw Cancelled once it returns true.
using Stop = bool (*)();

struct Cancelled {};

}  // namespace sim
