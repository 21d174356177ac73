#pragma once
#include <string>
#include <string_view>

namespace sim {

/// `text` made fit for one line of a message and for JSON: control characters and bytes that are no UTF-8 become '?',
/// what is longer than `most` bytes is cut.
std::string printable(std::string_view text, std::size_t most = 160);

}  // namespace sim
