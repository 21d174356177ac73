#pragma once
#include <string_view>

namespace fuzz {

/// Separates the parts of an input: header, contents, tree, then one part per tile.
inline constexpr std::string_view kBetween = "\n%%\n";

}  // namespace fuzz
