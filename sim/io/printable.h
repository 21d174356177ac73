#pragma once
#include <string>
#include <string_view>

namespace sim {

/// `text` made fit for one line of a message: control characters become '?', what is longer than `most` is cut.
std::string printable(std::string_view text, std::size_t most = 160);

}  // namespace sim
