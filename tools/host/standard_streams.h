#pragma once
#include <array>
#include <csignal>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace tools {

/// Opens the descriptors 0 to 2 that the parent process has closed, so that no file or socket gets one of these
/// numbers. Reads from standard input and writes to standard output still fail; text written to standard error is
/// discarded.
void open_closed_streams();

/// Signals sent on a write to a closed pipe, or past the file size limit (ulimit -f).
inline constexpr std::array<int, 2> kSignalsOfWrites = {SIGPIPE, SIGXFSZ};
/// Ignores kSignalsOfWrites, so that write() returns an error instead. Child processes must restore the default
/// handlers.
void ignore_write_signals();

/// Flushes standard output. Throws std::system_error if any write failed.
void flush_output();

/// Replaces non-ASCII signs ("±" by "+-") unless the terminal uses UTF-8 according to the first of LC_ALL, LC_CTYPE and
/// LANG that is set.
std::string to_terminal_encoding(std::string text);

/// Prints "raywatt: TEXT" to standard error. Ignores errors.
void print_message(std::string_view text);
template <class... Args>
void print_message(fmt::format_string<Args...> format, Args&&... args) {
  print_message(std::string_view(fmt::format(format, std::forward<Args>(args)...)));
}

/// Returns a word in single quotes for a shell.
std::string single_quoted(std::string_view word);

/// Returns a command for a shell; words are quoted where necessary.
std::string command_text(const std::vector<std::string>& words);

}  // namespace tools
