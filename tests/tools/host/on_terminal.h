#pragma once
#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/tools/program.h"

namespace test {

/// The raywatt program, running in a pseudo-terminal of 100 columns.
class OnTerminal {
 public:
  explicit OnTerminal(Words words, const std::vector<std::pair<std::string, std::string>>& variables = {}) {
    words.insert(words.begin(), RAYWATT_PROGRAM);
    winsize size{};
    size.ws_col = 100;
    process_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (process_ != 0) return;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::signal(signal, SIG_DFL);
    ::setenv("TERM", "xterm", 1);
    ::unsetenv("COLORTERM");
    for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(arguments.front(), arguments.data());
    ::_exit(127);
  }
  ~OnTerminal() {
    if (process_ > 0) ::kill(process_, SIGKILL), ::waitpid(process_, nullptr, 0);
    ::close(terminal_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  /// Reads the program's output until it contains the text `part`. Returns false if the output ends before.
  bool wait_for(const std::string& part) {
    char bytes[1024];
    while (screen_.find(part) == std::string::npos) {
      const ssize_t n = ::read(terminal_, bytes, sizeof bytes);
      if (n <= 0) return false;  // EIO after the end of the program
      screen_.append(bytes, static_cast<std::size_t>(n));
    }
    return true;
  }
  void type(char key) const { EXPECT_EQ(::write(terminal_, &key, 1), 1); }
  int wait() {
    wait_for("\x01 never sent");
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  const std::string& screen() const { return screen_; }

 private:
  pid_t process_ = -1;
  int terminal_ = -1;
  std::string screen_;
};

}  // namespace test
