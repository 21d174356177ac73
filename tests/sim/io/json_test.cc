#include "sim/io/json.h"

#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/io/json_number.h"

namespace sim::test {
namespace {

std::string nested(std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); }

TEST(Json, NestedDeeperIsToldFromAsDeep) {
  EXPECT_FALSE(is_nested_deeper(nested(5), 5));
  EXPECT_TRUE(is_nested_deeper(nested(6), 5));
  EXPECT_TRUE(is_nested_deeper(R"({"a": [{"b": {"c": []}}]})", 4));
  EXPECT_FALSE(is_nested_deeper(R"([[], {}, [[]], {"a": []}])", 3)) << "what is closed no longer counts";
}

TEST(Json, BracketsInStringsNestNothing) {
  EXPECT_FALSE(is_nested_deeper(R"(["[[[[", "\"[[[[", "\\"])", 1));
  EXPECT_TRUE(is_nested_deeper(R"(["\\", [["["]]])", 2));
}

TEST(Json, FromOutsideIsRefusedWhereItWouldExhaustTheStack) {
  EXPECT_EQ(parse_json<nlohmann::json>(nested(kDeepestJson)).size(), 1U);
  EXPECT_THROW(parse_json<nlohmann::json>(nested(kDeepestJson + 1)), InputError);
  EXPECT_THROW(parse_json<nlohmann::json>(nested(1'000'000)), InputError);
  EXPECT_THROW(parse_json<nlohmann::json>("[1, 2"), nlohmann::json::parse_error);
}

TEST(Json, NumbersFromOutsideAreWholeAndFit) {
  const auto read = [](const char* text) { return whole_number<std::uint32_t>(nlohmann::json::parse(text), "it"); };
  EXPECT_EQ(read("0"), 0U);
  EXPECT_EQ(read("4294967295"), 4'294'967'295U);
  for (const char* bad : {"4294967296", "-1", "1e300", "1.0", "true", "\"1\"", "null", "[1]"}) {
    EXPECT_THROW(read(bad), InputError) << bad;
  }
  EXPECT_EQ(whole_number<int>(nlohmann::json::parse("-3"), "it"), -3);
  EXPECT_THROW(whole_number<int>(nlohmann::json::parse("2147483648"), "it"), InputError);
}

}  // namespace
}  // namespace sim::test
