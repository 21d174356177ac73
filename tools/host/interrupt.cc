#include "tools/host/interrupt.h"

#include <atomic>
#include <csignal>
#include <string>
#include <string_view>

#include <unistd.h>

#include "sim/io/printable.h"

namespace tools {
namespace {

std::atomic<int> held = 0, waiting = 0;
std::atomic<bool> has_bar = false;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);
std::string kept_so_far;  ///< must not be used in the signal handler

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
  if (held == 0 || second)  // read last, as ~HoldInterrupts() reads `waiting` last, so at least one of the two sees the
                            // other's write
    end_process(signal, "raywatt: interrupted\n");
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

void set_bar_visible(bool bar_is_there) { has_bar = bar_is_there; }

HoldInterrupts::HoldInterrupts() { held += 1; }

HoldInterrupts::~HoldInterrupts() {
  held -= 1;
  if (held == 0 && waiting != 0) end_process(waiting, "raywatt: interrupted" + kept_so_far + "\n");
}

}  // namespace tools
