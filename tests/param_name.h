#pragma once
#include <cctype>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace test {

/// Turns a text into a name that GoogleTest accepts: other characters than letters and digits become underscores.
inline std::string name_of_text(std::string_view text) {
  std::string name;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (name.ends_with('_')) name.pop_back();
  return name;
}

/// Name generator for INSTANTIATE_TEST_SUITE_P. Names each test by its parameter: a text, a number, an enum with
/// names_of(), or a tuple of them.
struct ParamName {
  template <class T>
  static std::string name(const T& value) {
    if constexpr (std::is_enum_v<T>) {
      return name_of_text(names_of(value)[static_cast<std::size_t>(value)]);
    } else {
      return name_of_text(fmt::format("{}", value));
    }
  }
  template <class... Ts>
  static std::string name(const std::tuple<Ts...>& values) {
    return std::apply([](const auto&... each) { return name_of_text((... + (name(each) + "_"))); }, values);
  }
  template <class T>
  std::string operator()(const testing::TestParamInfo<T>& info) const {
    return name(info.param);
  }
};

}  // namespace test
