#include "tools/sweep/results/point_list.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace tools::results {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSettings[] = {"scene",   "camera",    "frames",       "resolution",
                                     "program", "reference", "tile_sampling"};

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

bool is_id(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// What is wrong with a line, or nothing and the point.
std::string read_point(std::string_view line, ListedPoint& point) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return "is no JSON object";
  const auto n = json.find("n"), id = json.find("id");
  if (n == json.end() || !n->is_number_unsigned()) return "has no number n";
  if (id == json.end() || !id->is_string() || !is_id(id->get<std::string>())) return "has no id of 64 hex digits";
  point.n = n->get<std::int64_t>();
  point.id = id->get<std::string>();
  if (const auto axes = json.find("axes"); axes != json.end()) {
    if (!axes->is_object()) return "has axes that are no object";
    for (const auto& [name, value] : axes->items()) {
      if (value.is_structured()) return fmt::format("has no plain value for the axis '{}'", sim::printable(name));
      point.axes.emplace_back(name, text_of(value));
    }
  }
  for (const char* key : kSettings) {
    const auto found = json.find(key);
    const bool is_axis =
        std::ranges::find(point.axes, key, &std::pair<std::string, std::string>::first) != point.axes.end();
    if (found != json.end() && found->is_string() && !is_axis) point.axes.emplace_back(key, found->get<std::string>());
  }
  return {};
}

}  // namespace

std::vector<ListedPoint> parse_point_list(std::string_view text, const std::string& shown_name) {
  std::vector<ListedPoint> points;
  for (std::size_t begin = 0, line = 1; begin < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    ListedPoint point;
    std::string problem = read_point(text.substr(begin, end - begin), point);
    if (problem.empty() && !points.empty() && point.n <= points.back().n) {
      problem = fmt::format("has n {} after {}", point.n, points.back().n);
    }
    if (!problem.empty()) throw sim::InputError(fmt::format("{}:{}: the point {}", shown_name, line, problem));
    points.push_back(std::move(point));
    begin = end + 1;
  }
  if (points.empty()) throw sim::InputError(shown_name + ": holds no point");
  return points;
}

}  // namespace tools::results
