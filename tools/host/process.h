#pragma once

#include <functional>
#include <string>

#include <sys/types.h>

#include "sim/error.h"

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

/// Installs handlers: SIGINT, SIGTERM and SIGHUP end the process with 128 + the signal and one line on stderr. Signals
/// that the parent process ignores stay ignored.
void install_interrupt_handlers();

/// Delays interrupts while an object of this class exists, so that no results are lost and no files are left half
/// written. A second interrupt is not delayed. The destructor of the last object ends the process if an interrupt is
/// pending.
class HoldInterrupts {
 public:
  HoldInterrupts();
  ~HoldInterrupts();
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;
};

/// Sets the text that follows "interrupted" in the message of a delayed interrupt, e.g. "kept 3 of 10 frames in out".
void set_interrupt_note(const std::string& kept);

/// Sets whether the last line of the terminal is a progress bar, which an interrupt erases before its message.
void set_bar_visible(bool is_visible);

/// True if an interrupt is pending.
bool is_interrupted();

/// Thrown by long computations when an interrupt is pending.
using Interrupted = sim::Cancelled;

/// A child process that sends a text through a pipe and exits with 0. It is killed if its parent ends first. Interrupts
/// end it without a message, because the parent prints one.
class ChildProcess {
 public:
  /// Starts the child, which calls `make_text` and sends the text. Throws std::system_error if no process can be
  /// started; in the child, exceptions of `make_text` leave the constructor.
  explicit ChildProcess(const std::function<std::string()>& make_text);
  /// Kills the child process if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns the reading end of the pipe from the child, for poll().
  int pipe_end() const { return pipe_end_; }
  /// Waits for output of the child process and reads it. Returns false at the end of the output.
  bool receive_data();
  const std::string& received_text() const { return text_; }
  /// Waits until the child has ended and returns its exit status in the format of waitpid().
  int wait_for_exit();

 private:
  pid_t process_ = -1;
  int pipe_end_ = -1;
  std::string text_;
};

}  // namespace tools
