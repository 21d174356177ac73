#pragma once
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"

namespace sim {

/// Converts untrusted JSON to a whole number that fits T. Throws InputError that begins with `what` otherwise; get()
/// would convert any number.
template <class T>
T whole_number(const Json& json, std::string_view what) {
  if (json.is_number_unsigned()) {
    const auto number = json.get<std::uint64_t>();
    if (std::in_range<T>(number)) return static_cast<T>(number);
  } else if (json.is_number_integer()) {
    const auto number = json.get<std::int64_t>();
    if (std::in_range<T>(number)) return static_cast<T>(number);
  }
  throw InputError(fmt::format("{} is no whole number from {} to {}", what, std::numeric_limits<T>::min(),
                               std::numeric_limits<T>::max()));
}

}  // namespace sim
