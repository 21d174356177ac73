#pragma once

namespace tools {

/// From now on SIGINT, SIGTERM and SIGHUP end the process with 128 + the signal and one line on stderr. A signal that
/// the caller has it ignore stays ignored.
void end_on_interrupts();

/// While it lives, interrupts wait: for the moments in which files are half made.
class HoldInterrupts {
 public:
  HoldInterrupts();
  ~HoldInterrupts();
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;
};

}  // namespace tools
