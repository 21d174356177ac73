#pragma once
#include <string>
#include <string_view>

namespace sim {

/// Makes a text safe to print in one line of a message: control characters and bytes that are not UTF-8 become '?', and
/// the text is cut after `max_bytes` bytes.
std::string printable(std::string_view text, std::size_t max_bytes = 160);

/// Converts a text to valid UTF-8, for JSON. Bytes that are not UTF-8, such as in file names, become an escape like
/// "\\xff".
std::string with_escaped_bytes(std::string_view text);

}  // namespace sim
