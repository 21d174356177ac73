#pragma once
#include <functional>
#include <string>

#include <sys/types.h>

namespace tools {

/// A child process that sends a text through a pipe and exits with 0. It is killed if its parent ends first. Interrupts
/// end it without a message, because the parent prints one.
class ChildProcess {
 public:
  /// `make_text` is called in the child, where its exceptions leave the constructor. std::system_error without a child.
  explicit ChildProcess(const std::function<std::string()>& make_text);
  /// Kills the child if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns the reading end of the pipe, for poll().
  int pipe_end() const { return pipe_end_; }
  /// Waits for data and reads them. Returns false at the end of the text.
  bool receive_data();
  const std::string& received_text() const { return text_; }
  /// Waits for the end and returns the status of waitpid().
  int wait_for_exit();

 private:
  pid_t process_ = -1;
  int pipe_end_ = -1;
  std::string text_;
};

}  // namespace tools
