#pragma once
#include <array>
#include <csignal>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace tools {

/// Opens those of the descriptors 0 to 2 that the caller has closed, so that no file or socket of the program gets one
/// of them. Reading and writing standard input and output still fail; standard error takes everything.
void open_closed_streams();

/// Signals that end a process which writes where nobody reads any more, or past the caller's limit (ulimit -f).
inline constexpr std::array<int, 2> kSignalsOfWrites = {SIGPIPE, SIGXFSZ};
/// Ignores them from now on: write() fails, which is told as any failure is. Programs that this one starts are to have
/// them as usual.
void outlive_failed_writes();

/// Writes what standard output still holds. std::system_error if it could not take all that was written to it.
void flush_output();

/// Text as the locale's characters can show it: signs that are not ASCII ("±") become letters ("+-") unless LC_ALL,
/// LC_CTYPE or LANG, the first that is set, names UTF-8.
std::string for_terminal(std::string text);

/// Writes "raywatt: TEXT" and the end of the line to standard error. Text that cannot be written is lost.
void tell(std::string_view text);
template <class... Args>
void tell(fmt::format_string<Args...> format, Args&&... args) {
  tell(std::string_view(fmt::format(format, std::forward<Args>(args)...)));
}

}  // namespace tools
