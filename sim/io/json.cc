#include "sim/io/json.h"

#include <fmt/format.h>

#include "sim/error.h"

namespace sim {

bool is_nested_deeper(std::string_view json, std::size_t levels) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > levels) return true;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return false;
}

void check_json_depth(std::string_view json, std::size_t levels) {
  if (is_nested_deeper(json, levels)) {
    throw InputError(fmt::format("is nested too deeply; allowed: {} levels", levels));
  }
}

}  // namespace sim
