#pragma once
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"

namespace sim {

/// A whole number from outside that T holds. InputError that begins with `what` for anything else: the parser's own
/// get() converts whatever it finds.
template <class T, class Json>
T whole_number(const Json& json, std::string_view what) {
  const bool fits = json.is_number_unsigned()
                        ? std::in_range<T>(json.template get<std::uint64_t>())
                        : json.is_number_integer() && std::in_range<T>(json.template get<std::int64_t>());
  if (fits) return json.template get<T>();
  throw InputError(fmt::format("{} is no whole number from {} to {}", what, std::numeric_limits<T>::min(),
                               std::numeric_limits<T>::max()));
}

}  // namespace sim
