#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "sim/io/json.h"

namespace tools::sweep {

constexpr std::size_t kLogTail = 2000;  ///< bytes of what a worker says that are kept

/// Throws what errno says.
[[noreturn]] void give_up(const char* what);

void send_message(int socket, const sim::Json& message);
/// Nothing if the other side is gone.
std::optional<sim::Json> receive_message(int socket);

/// 0 if there is none.
std::uint64_t size_of(const std::filesystem::path& file);

}  // namespace tools::sweep
