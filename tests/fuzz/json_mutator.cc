#include <random>
#include <vector>

#include <nlohmann/json.hpp>

#include "sim/io/json.h"
#include "tests/fuzz/common.h"

namespace fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kGrow = 16;

void collect(Json& value, std::vector<Json*>& all) {
  all.push_back(&value);
  if (!value.is_structured()) return;
  for (Json& child : value) collect(child, all);
}

/// Returns an extreme value.
const Json& edge(std::size_t number) {
  static const Json kValues = Json::parse(
      "[0, 1, 2, -1, 255, 65536, 2147483647, 4294967295, 4294967296, 9007199254740993, 18446744073709551615, "
      "-9223372036854775808, 0.5, 1e-300, 1e300, -1e300, \"\", \"text\", \"a.b\", null, true, [], {}, [0, 0], "
      "[[[[[[[[[1]]]]]]]]], {\"a\": 1}]");
  return kValues[number % kValues.size()];
}

void change_value(Json& value, std::size_t number) {
  if (value.is_string() && number % 2 == 0) {
    value = mutated_bytes(value.get<std::string>(), kGrow);
  } else if (value.is_number_integer() && number % 2 == 0) {
    value = static_cast<std::int64_t>(value.get<std::uint64_t>() + number % 9 - 4);
  } else {
    value = edge(number / 2);
  }
}

void erase_one(Json& value, std::size_t number) {
  auto victim = value.begin();
  std::advance(victim, static_cast<std::ptrdiff_t>(number % value.size()));
  value.erase(victim);
}

}  // namespace

std::string mutated_json(std::string_view text, unsigned seed) {
  if (sim::is_nested_deeper(text, sim::kDeepestJson)) return {};
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return {};
  std::minstd_rand random(seed);
  std::vector<Json*> all;
  collect(json, all);
  Json& value = *all[random() % all.size()];
  const Json other = *all[random() % all.size()];
  switch (random() % 4) {
    case 0:
      if (value.is_structured() && !value.empty()) {
        erase_one(value, random());
        break;
      }
      [[fallthrough]];
    case 1:
      if (value.is_array()) {
        value.push_back(other);
        break;
      }
      [[fallthrough]];
    case 2:
      value = other;
      break;
    default:
      change_value(value, random());
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fuzz
