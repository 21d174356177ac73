#pragma once
#include <string>

#include "sim/error.h"

namespace tools {

/// Installs handlers: SIGINT, SIGTERM and SIGHUP end the process with 128 + the signal and one line on stderr. Signals
/// that the parent process ignores stay ignored.
void install_interrupt_handlers();

/// Delays interrupts while an object exists, so that no results are lost and no files are left half written. A second
/// interrupt is not delayed. The destructor of the last object ends the process if an interrupt is pending.
class HoldInterrupts {
 public:
  HoldInterrupts();
  ~HoldInterrupts();
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;
};

/// Sets the text after "interrupted" in the message of a delayed interrupt: "kept 3 of 10 frames in out".
void set_interrupt_note(const std::string& kept);

/// Sets whether the last line of the terminal is a progress bar, which an interrupt erases before its message.
void set_bar_visible(bool bar_is_there);

/// True if an interrupt is pending.
bool is_interrupted();

/// Thrown by long computations when an interrupt is pending.
using Interrupted = sim::Cancelled;

}  // namespace tools
