#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace sim {

/// Levels of any JSON file of ours.
inline constexpr std::size_t kDeepestJson = 64;

/// Does the JSON nest objects and lists deeper than that? Whoever walks through it, the parser's own values too, takes
/// a frame of the stack for each level. Text that is no JSON may give either answer.
bool is_nested_deeper(std::string_view json, std::size_t levels);

/// InputError for JSON that is nested deeper than that.
void check_json_depth(std::string_view json, std::size_t levels = kDeepestJson);

/// JSON as a line, and as text of many lines. Bytes that are no UTF-8 become U+FFFD: nothing that has been found is
/// lost for a name's sake (printable.h has with_escaped_bytes).
template <class Json>
std::string json_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}
template <class Json>
std::string json_lines(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// JSON from outside. InputError as check_json_depth(); nlohmann's exceptions for text that is no JSON.
template <class Json>
Json parse_json(std::string_view text, std::size_t levels = kDeepestJson) {
  check_json_depth(text, levels);
  return Json::parse(text);
}

/// Hands JSON from outside to a reader of nlohmann's events, piece by piece; complaints as parse_json().
template <class Json, class Reader>
void scan_json(std::string_view text, Reader& reader) {
  check_json_depth(text);
  Json::sax_parse(text.begin(), text.end(), &reader);
}

}  // namespace sim
