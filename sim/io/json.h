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

/// InputError for JSON that is nested deeper than kDeepestJson.
void check_json_depth(std::string_view json);

/// JSON from outside. InputError as check_json_depth(); nlohmann's exceptions for text that is no JSON.
template <class Json>
Json parse_json(const std::string& text) {
  check_json_depth(text);
  return Json::parse(text);
}

}  // namespace sim
