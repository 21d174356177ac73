#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tools::results {

/// A line of points.jsonl: what a point is, not what became of it.
struct ListedPoint {
  std::int64_t n = 0;
  std::string id;  ///< 64 hexadecimal digits
  /// Name and value: its axes in the order given, then what else it says of the run: scene, program, ...
  std::vector<std::pair<std::string, std::string>> axes;
};

/// The points of a sweep in their order. InputError with the line for what is no point, and for numbers that are not
/// counted up.
std::vector<ListedPoint> parse_point_list(std::string_view text, const std::string& shown_name);

}  // namespace tools::results
