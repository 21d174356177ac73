#include "tools/host/process.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/io/printable.h"

namespace tools {
namespace {

std::atomic<int> held = 0, waiting = 0;
std::atomic<bool> has_bar = false;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);
std::string kept_so_far;  ///< text after "interrupted" in the message; the signal handler must not use it

void write_words(std::string_view words) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, words.data(), words.size());
}

[[noreturn]] void end_process(int signal, std::string_view words) {
  if (has_bar) write_words("\r\x1b[K");
  write_words(words);
  ::_exit(128 + signal);
}

extern "C" void on_interrupt(int signal) {
  const bool second = waiting.exchange(signal) != 0;
  // This handler writes `waiting` before it reads `held`; ~HoldInterrupts() writes `held` before it reads `waiting`. So
  // at least one of the two sees the other's write.
  if (held == 0 || second) end_process(signal, "raywatt: interrupted\n");
}

}  // namespace

void install_interrupt_handlers() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action = {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = on_interrupt;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
}

bool is_interrupted() { return waiting != 0; }

void set_interrupt_note(const std::string& kept) { kept_so_far = "; " + sim::printable(kept, std::string::npos); }

void set_bar_visible(bool is_visible) { has_bar = is_visible; }

HoldInterrupts::HoldInterrupts() { held += 1; }

HoldInterrupts::~HoldInterrupts() {
  held -= 1;
  if (held == 0 && waiting != 0) end_process(waiting, "raywatt: interrupted" + kept_so_far + "\n");
}

namespace {

[[noreturn]] void throw_errno(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0) throw_errno("pipe");
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

ChildProcess::ChildProcess(const std::function<std::string()>& make_text) {
  int ends[2];
  if (::pipe(ends) != 0) throw_errno("pipe");
  process_ = ::fork();
  if (process_ < 0) throw_errno("fork");
  if (process_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    ::close(ends[0]);
    write_all(ends[1], make_text());
    std::_Exit(0);
  }
  ::close(ends[1]);
  pipe_end_ = ends[0];
}

ChildProcess::~ChildProcess() {
  ::close(pipe_end_);
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  wait_for_exit();
}

bool ChildProcess::receive_data() {
  char part[1 << 16];
  const ssize_t n = ::read(pipe_end_, part, sizeof part);
  if (n > 0) text_.append(part, static_cast<std::size_t>(n));
  if (n < 0 && errno != EINTR) throw_errno("pipe");
  return n != 0;
}

int ChildProcess::wait_for_exit() {
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

}  // namespace tools
