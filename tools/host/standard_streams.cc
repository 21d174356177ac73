#include "tools/host/standard_streams.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace tools {

void open_closed_streams() {
  // open() returns the lowest free descriptor, which is the closed stream's own number in this order.
  for (const auto& [stream, mode] :
       {std::pair{STDIN_FILENO, O_WRONLY}, {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}}) {
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) static_cast<void>(::open("/dev/null", mode));
  }
}

void ignore_write_signals() {
  for (const int signal : kSignalsOfWrites) std::signal(signal, SIG_IGN);
}

void flush_output() {
  int error = std::fflush(stdout) != 0 ? errno : 0;
  if (error == 0 && std::ferror(stdout) != 0) error = EIO;  // an earlier write failed
  if (error != 0) throw std::system_error(error, std::generic_category(), "standard output");
}

namespace {

bool locale_has_utf8() {
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* const locale = std::getenv(variable);
    if (locale == nullptr || *locale == '\0') continue;
    const std::string_view name = locale;
    for (const char* word : {"UTF-8", "utf-8", "UTF8", "utf8"}) {
      if (name.find(word) != std::string_view::npos) return true;
    }
    return false;
  }
  return false;
}

}  // namespace

std::string to_terminal_encoding(std::string text) {
  constexpr std::string_view kSign = "\u00b1";
  if (locale_has_utf8()) return text;
  for (std::size_t at = 0; (at = text.find(kSign, at)) != std::string::npos;) text.replace(at, kSign.size(), "+-");
  return text;
}

void print_message(std::string_view text) {
  const std::string line = fmt::format("raywatt: {}\n", text);
  static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
}

namespace {

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:,=%+@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  return single_quoted(word);
}

}  // namespace

std::string single_quoted(std::string_view word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_text(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + shell_word(word);
  return out;
}

}  // namespace tools
