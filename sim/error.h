#pragma once
#include <stdexcept>
#include <string>

namespace sim {

/// The user's input cannot be used: says where (file, line, column, key), what was wrong and what is allowed. Exit 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reading or writing failed (no such folder, disk full, no permission after the run had begun). Exit 74.
struct IoError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The machine is stuck: no unit will ever have something to do again, or units go on and retire nothing, and work is
/// left. Exit 3.
struct Deadlock : std::runtime_error {
  Deadlock(const std::string& what, std::string machine_state)
      : std::runtime_error(what), state(std::move(machine_state)) {}
  std::string state;  ///< one line per unit
};

}  // namespace sim
