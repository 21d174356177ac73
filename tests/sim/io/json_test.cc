#include "sim/io/json.h"

#include <bit>
#include <limits>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"

namespace sim::test {
namespace {

using Library = nlohmann::ordered_json;

/// Returns the text that nlohmann::json writes, on one line or indented.
std::string written(const Library& json, int indent) {
  return json.dump(indent, ' ', false, Library::error_handler_t::replace);
}

/// Generator of random JSON values: arbitrary bits as numbers, arbitrary bytes as texts and keys.
class RandomValue {
 public:
  Library next(int levels) {
    switch (below(levels == 0 ? 6 : 8)) {
      case 0:
        return nullptr;
      case 1:
        return below(2) == 0;
      case 2:
        return static_cast<std::int64_t>(random_() >> below(64)) * (below(2) == 0 ? 1 : -1);
      case 3:
        return random_() >> below(64);
      case 4:
        return fraction();
      case 5:
        return text();
      case 6: {
        Library list = Library::array();
        for (auto n = below(5); n > 0; --n) list.push_back(next(levels - 1));
        return list;
      }
      default: {
        Library object = Library::object();
        for (auto n = below(40); n > 0; --n) object[text()] = next(levels - 1);
        return object;
      }
    }
  }

 private:
  std::uint64_t below(std::uint64_t end) { return random_() % end; }
  double fraction() {
    const std::uint64_t kind = below(4);
    if (kind == 0) return std::bit_cast<double>(random_());  // any exponent, including NaN
    if (kind == 1) return static_cast<double>(random_() % 1'000'000) / 1000;
    if (kind == 2) return static_cast<double>(random_() >> below(64));
    return std::ldexp(1, static_cast<int>(below(2100)) - 1075);
  }
  std::string text() {
    std::string text;
    const bool any = below(2) == 0;
    for (auto n = below(12); n > 0; --n) text += static_cast<char>(any ? below(256) : 'a' + below(26));
    return text;
  }

  std::mt19937_64 random_{7};
};

/// Builds the same value with the functions of sim::Json.
Json copy_of(const Library& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_unsigned()) return json.get<std::uint64_t>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  Json copy;
  if (json.is_array()) copy = Json::array();
  if (json.is_object()) copy = Json::object();
  for (const auto& [key, value] : json.items()) {
    if (json.is_array()) {
      copy.push_back(copy_of(value));
    } else {
      copy[key] = copy_of(value);
    }
  }
  return copy;
}

TEST(JsonText, IsThatOfTheLibraryToTheLastByte) {
  RandomValue random;
  for (int i = 0; i < 2000; ++i) {
    const Library library = random.next(4);
    const Json json = copy_of(library);
    ASSERT_EQ(json_line(json), written(library, -1));
    ASSERT_EQ(json_lines(json), written(library, 2) + "\n");
    ASSERT_EQ(json_line(parse_json(json_line(json))), written(Library::parse(written(library, -1)), -1));
    ASSERT_EQ(json_line(json.flatten()), written(library.flatten(), -1));
  }
}

TEST(JsonText, ReplacesBytesThatAreNoUtf8) { EXPECT_EQ(json_line("a\xff\"\n"), "\"a\xef\xbf\xbd\\\"\\n\""); }

TEST(JsonList, IsAnObjectIfAllElementsAreAKeyAndAValue) {
  EXPECT_EQ(json_line({{"a", 1}, {"b", {1, 2}}, {"a", 3}}), R"({"a":1,"b":[1,2]})") << "the first of equal keys";
  EXPECT_EQ(json_line({{"a", 1}, {"b", 1, 2}}), R"([["a",1],["b",1,2]])");
  EXPECT_EQ(json_line({{"a", "b"}}), R"({"a":"b"})");
  EXPECT_EQ(json_line({"a", "b"}), R"(["a","b"])");
  EXPECT_EQ(json_line(Json::array({{"a", 1}})), R"([["a",1]])") << "asked for";
  EXPECT_EQ(json_line(Json({})), "{}");
  EXPECT_TRUE(Json{}.is_null());
  const Json kept = {{"long enough to be on the heap", 1}};
  EXPECT_EQ(json_line({kept, kept}), "[" + json_line(kept) + "," + json_line(kept) + "]");
  EXPECT_EQ(kept.size(), 1U) << "only elements of the list are moved";
}

TEST(JsonObject, KeepsTheOrderOfItsKeysAndFindsEach) {
  for (const std::size_t count : {1U, 16U, 17U, 1000U}) {
    Json object;
    for (std::size_t i = 0; i < count; ++i) object[std::to_string(i * 7919 % 1009)] = i;
    ASSERT_EQ(object.size(), count);
    const Json copy = object;
    std::size_t i = 0;
    for (const auto& [key, value] : copy.items()) {
      EXPECT_EQ(key, std::to_string(i * 7919 % 1009));
      EXPECT_EQ(value, i);
      EXPECT_EQ(copy.at(key), i++);
    }
    EXPECT_FALSE(copy.contains("x"));
    EXPECT_EQ(copy.find("x"), copy.end());
    object.erase("0");
    EXPECT_EQ(object.size(), count - 1);
    EXPECT_FALSE(object.contains("0"));
    object.update(copy);
    EXPECT_EQ(object.back(), 0) << "it is the last now";
    object.sort_keys();
    EXPECT_TRUE(std::ranges::is_sorted(object.items(), {}, &Json::Entry::key));
    EXPECT_EQ(object.at("0"), 0);
  }
}

TEST(JsonObject, CountsTheLastOfEqualKeysAtThePlaceOfTheFirst) {
  EXPECT_EQ(json_line(parse_json(R"({"a": 1, "b": 2, "a": [3]})")), R"({"a":[3],"b":2})");
}

std::string object_of(std::size_t keys) {
  std::string text = "{";
  for (std::size_t i = 0; i < keys; ++i) text += (i == 0 ? "\"" : ",\"") + std::to_string(i) + "\":0";
  return text + "}";
}

// Takes a fifth of a second; a linear search per key took more than a minute.
TEST(JsonObject, OfManyKeysIsParsedInLinearTime) {
  EXPECT_EQ(parse_json(object_of(kMostJsonKeys)).size(), kMostJsonKeys);
}

TEST(JsonObject, OfTooManyKeysIsRefused) {
  try {
    parse_json("[" + object_of(kMostJsonKeys + 1) + "]");
    FAIL() << "is not refused";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "has an object of too many keys; allowed: 250000 keys");
  }
}

TEST(JsonValue, HasEqualNumbersWhateverTheirTypes) {
  EXPECT_EQ(Json(3), Json(3U));
  EXPECT_EQ(Json(3), Json(3.0));
  EXPECT_NE(Json(-1), Json(std::numeric_limits<std::uint64_t>::max()));
  EXPECT_NE(Json(1), Json(true));
  EXPECT_NE(Json({{"a", 1}, {"b", 2}}), Json({{"b", 2}, {"a", 1}})) << "order counts";
  EXPECT_EQ(Json(1e300).get<std::uint32_t>(), std::numeric_limits<std::uint32_t>::max());
  EXPECT_EQ(Json(-1.5).get<int>(), -1);
}

TEST(JsonValue, OfAnotherTypeIsRefusedAsTheLibraryDoes) {
  const auto said = [](auto&& f) -> std::string {
    try {
      f();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "nothing";
  };
  const std::string text = R"({"n": 1, "s": "x", "l": [1], "o": {}, "z": null, "t": true})";
  const Json ours = parse_json(text);
  const Library theirs = Library::parse(text);
  for (const char* key : {"n", "s", "l", "o", "z", "t"}) {
    const auto same = [&](auto&& f) {
      EXPECT_EQ(said([&] { f(ours.at(key)); }), said([&] { f(theirs.at(key)); })) << key;
    };
    same([](const auto& json) { return json.template get<std::string>(); });
    same([](const auto& json) { return json.template get<bool>(); });
    same([](const auto& json) { return json.template get<double>(); });
    same([](const auto& json) { return json.template get<std::vector<double>>(); });
    same([](const auto& json) { return json.at("k"); });
    same([](const auto& json) { return json.at(1); });
    same([](const auto& json) { return json.value("k", 1.5); });
    same([](auto json) { json["k"] = 1; });
    same([](auto json) { json.push_back(1); });
    same([](auto json) { json.update({{"a", 1}}); });
  }
  for (const char* bad : {"", "[1, 2", "{\"a\" 1}", "nul", "\"\xff\"", "1e999", "[1] 2", "{\"a\": 1,}"}) {
    EXPECT_EQ(said([&] { parse_json(bad); }), said([&] { return Library::parse(bad); })) << bad;
  }
}

TEST(JsonValue, OtherThanAnObjectHasNoEntries) {
  EXPECT_TRUE(Json().items().empty());
  EXPECT_THROW(Json({1, 2}).items(), JsonError);
  EXPECT_THROW(Json(1).items(), JsonError);
}

TEST(JsonPointers, FollowKeysAndIndices) {
  const Json json = parse_json(R"({"a": [{"b/c": 1}, {"~": 2}], "d": {"": 3}})");
  EXPECT_EQ(json.at(JsonPointer("/a/0/b~1c")), 1);
  EXPECT_EQ(json.at(JsonPointer("/a/1/~0")), 2);
  EXPECT_EQ(json.at(JsonPointer("/d/")), 3);
  for (const char* absent : {"/a/2", "/a/x", "/a/0/b", "/d/x", "/d//x"}) {
    EXPECT_FALSE(json.contains(JsonPointer(absent))) << absent;
    EXPECT_THROW(json.at(JsonPointer(absent)), JsonError) << absent;
  }
  Json made;
  made[JsonPointer("/a/b")] = 1;
  made[JsonPointer("/a/c/1")] = 2;
  EXPECT_EQ(json_line(made), R"({"a":{"b":1,"c":[null,2]}})");
}

TEST(JsonStream, HoldsOneValueAfterAnother) {
  std::istringstream text("{\"a\": 1} [2]\n3");
  EXPECT_EQ(json_line(parse_json(text)), R"({"a":1})");
  EXPECT_EQ(json_line(parse_json(text)), "[2]");
  EXPECT_EQ(json_line(parse_json(text)), "3");
  EXPECT_THROW(parse_json(text), JsonError);
}

std::string nested(std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); }

TEST(Json, DetectsNestingBeyondTheLimitOnly) {
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
  EXPECT_EQ(parse_json(nested(kDeepestJson)).size(), 1U);
  EXPECT_THROW(parse_json(nested(kDeepestJson + 1)), InputError);
  EXPECT_THROW(parse_json(nested(1'000'000)), InputError);
  EXPECT_THROW(parse_json("[1, 2"), JsonError);
}

TEST(Json, NumbersFromOutsideAreWholeAndFit) {
  const auto read = [](const char* text) { return whole_number<std::uint32_t>(parse_json(text), "it"); };
  EXPECT_EQ(read("0"), 0U);
  EXPECT_EQ(read("4294967295"), 4'294'967'295U);
  for (const char* bad : {"4294967296", "-1", "1e300", "1.0", "true", "\"1\"", "null", "[1]"}) {
    EXPECT_THROW(read(bad), InputError) << bad;
  }
  EXPECT_EQ(whole_number<int>(parse_json("-3"), "it"), -3);
  EXPECT_THROW(whole_number<int>(parse_json("2147483648"), "it"), InputError);
}

}  // namespace
}  // namespace sim::test
