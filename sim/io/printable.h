#pragma once
#include <string>
#include <string_view>

namespace sim {

/// Returns a text that is safe in one line of a message: control characters and bytes that are not UTF-8 become '?'.
/// The text is cut after `max_bytes` bytes.
std::string printable(std::string_view text, std::size_t max_bytes = 160);

/// Returns a text as valid UTF-8, for JSON: bytes that are not UTF-8, such as in file names, become "\\xff".
std::string with_escaped_bytes(std::string_view text);

}  // namespace sim
