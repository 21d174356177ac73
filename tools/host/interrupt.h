#pragma once
#include <string>

#include "sim/error.h"

namespace tools {

/// From now on SIGINT, SIGTERM and SIGHUP end the process with 128 + the signal and one line on stderr. A signal that
/// the caller has it ignore stays ignored.
void end_on_interrupts();

/// While one lives, interrupts wait: for the times in which something would be lost or files are half made. The second
/// interrupt waits no longer. The end of the last one ends the process if an interrupt waits.
class HoldInterrupts {
 public:
  HoldInterrupts();
  ~HoldInterrupts();
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;
};

/// Text that the line on stderr adds when an interrupt has waited: "kept 3 of 10 frames in out".
void tell_if_interrupted(const std::string& kept);

/// The terminal's last line is a bar, or no longer: an interrupt erases it before it says its own.
void erase_if_interrupted(bool bar_is_there);

/// Does an interrupt wait?
bool interrupted();

/// Thrown by long work that has seen interrupted().
using Interrupted = sim::Cancelled;

}  // namespace tools
