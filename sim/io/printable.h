#pragma once
#include <string>
#include <string_view>

namespace sim {

/// `text` made fit for one line of a message and for JSON: control characters and bytes that are no UTF-8 become '?',
/// what is longer than `most` bytes is cut.
std::string printable(std::string_view text, std::size_t most = 160);

/// `text` as JSON can hold it: bytes that are no UTF-8, which names of files may have, become "\\xff".
std::string with_escaped_bytes(std::string_view text);

}  // namespace sim
