#include "tools/studies/sweep/launch/worker_channel.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <sys/socket.h>

#include "sim/io/json.h"

namespace tools::sweep {

using sim::Json;

void give_up(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

void send_message(int socket, const Json& message) {
  const std::string text = sim::json_line(message);
  if (::send(socket, text.data(), text.size(), MSG_NOSIGNAL) < 0 && errno != EPIPE && errno != ECONNRESET) {
    give_up("a worker cannot be told what to do");
  }
}

std::optional<Json> receive_message(int socket) {
  for (;;) {
    char first = 0;
    const ssize_t size = ::recv(socket, &first, 1, MSG_PEEK | MSG_TRUNC);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return std::nullopt;
    std::string text(static_cast<std::size_t>(size), '\0');
    if (::recv(socket, text.data(), text.size(), 0) != size) return std::nullopt;
    return sim::parse_json(text);
  }
}

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code missing;
  const std::uint64_t size = std::filesystem::file_size(file, missing);
  return missing ? 0 : size;
}

}  // namespace tools::sweep
