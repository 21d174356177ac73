#include "sim/io/json.h"

#include <gtest/gtest.h>

#include "sim/error.h"

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

}  // namespace
}  // namespace sim::test
