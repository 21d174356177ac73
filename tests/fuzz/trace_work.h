#pragma once
#include <string_view>

namespace fuzz {

/// Stands between the parts of an input: header, contents, tree, then a tile each.
inline constexpr std::string_view kBetween = "\n%%\n";

}  // namespace fuzz
