#pragma once
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"

namespace sim {

/// A whole number from outside that T holds. InputError that begins with `what` for anything else:
/// get() converts any number.
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
