#pragma once

namespace tools {

/// From now on SIGINT, SIGTERM and SIGHUP end the process with 128 + the signal and one line on stderr. A signal that
/// the caller has it ignore stays ignored.
void end_on_interrupts();

/// While it lives, interrupts wait: for the times in which files are half made. The second one waits no longer.
class HoldInterrupts {
 public:
  HoldInterrupts();
  ~HoldInterrupts();
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;
};

/// Does an interrupt wait?
bool interrupted();

/// Thrown by long work that has seen interrupted().
struct Interrupted {};

}  // namespace tools
