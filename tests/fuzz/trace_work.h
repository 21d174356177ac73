#pragma once
#include <string_view>

namespace fuzz {

/// Text that separates the parts of a fuzz input: trace header, contents, tree, then one part per tile.
inline constexpr std::string_view kBetween = "\n%%\n";

}  // namespace fuzz
