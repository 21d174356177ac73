#include "tools/interrupt.h"

#include <atomic>
#include <csignal>
#include <string_view>

#include <unistd.h>

namespace tools {

namespace {

std::atomic<bool> held = false;
std::atomic<int> waiting = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

[[noreturn]] void end(int signal) {
  constexpr std::string_view kWords = "raywatt: interrupted\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kWords.data(), kWords.size());
  ::_exit(128 + signal);
}

extern "C" void on_interrupt(int signal) {
  const bool second = waiting.exchange(signal) != 0;
  if (!held || second)
    end(signal);  // read last, as ~HoldInterrupts reads `waiting` last: one of the two sees the other
}

}  // namespace

void end_on_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action = {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = on_interrupt;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
}

bool interrupted() { return waiting != 0; }

HoldInterrupts::HoldInterrupts() { held = true; }

HoldInterrupts::~HoldInterrupts() {
  held = false;
  if (waiting != 0) end(waiting);
}

}  // namespace tools
