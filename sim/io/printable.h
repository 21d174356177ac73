#pragma once
#include <string>
#include <string_view>

namespace sim {

/// Makes `text` safe for one line of a message: control characters and bytes that are not UTF-8 become '?'. Cut after
/// `most` bytes.
std::string printable(std::string_view text, std::size_t most = 160);

/// Makes `text` valid UTF-8 for JSON: other bytes, such as in file names, become "\\xff".
std::string with_escaped_bytes(std::string_view text);

}  // namespace sim
