#include "tools/studies/report/page/page_model.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "sim/report/table.h"

namespace tools::pages {
namespace {

constexpr std::array<const char*, 4> kShow = {"text", "number", "si", "percent"};
constexpr std::size_t kLongestText = 2000;
constexpr double kWhole = 1e4;  ///< from here on numbers have a prefix

const char* name_of(Show show) { return kShow.at(static_cast<std::size_t>(show)); }

}  // namespace

Json Dataset::json() const {
  Json columns = Json::array();
  for (const Column& column : columns_) {
    Json entry = {{"field", column.field}, {"title", column.title}, {"show", name_of(column.show)}};
    if (!column.unit.empty()) entry["unit"] = column.unit;
    columns.push_back(std::move(entry));
  }
  return {{"columns", std::move(columns)}, {"rows", rows_}};
}

Section::Section(std::string id, std::string title, std::string lead)
    : json_{{"id", std::move(id)}, {"title", std::move(title)}, {"lead", std::move(lead)}, {"blocks", Json::array()}} {}

void Section::text(std::string words) { json_["blocks"].push_back({{"type", "text"}, {"text", std::move(words)}}); }

void Section::chart(std::string id, std::string title, std::string about, std::string dataset, Json chart) {
  block("chart", std::move(id), std::move(title),
        {{"about", std::move(about)}, {"data", std::move(dataset)}, {"chart", std::move(chart)}});
}

void Section::table(std::string id, std::string title, std::string dataset) {
  block("table", std::move(id), std::move(title), {{"data", std::move(dataset)}});
}

void Section::block(std::string type, std::string id, std::string title, Json more) {
  Json entry = {{"type", std::move(type)}, {"id", std::move(id)}, {"title", std::move(title)}};
  entry.update(more);
  json_["blocks"].push_back(std::move(entry));
}

View::View(std::string name)
    : json_{{"name", std::move(name)},  {"verdict", nullptr},         {"facts", Json::array()},
            {"notices", Json::array()}, {"headlines", Json::array()}, {"sections", Json::array()},
            {"data", Json::object()}} {}

void View::verdict(std::string sentence, std::string more, std::vector<std::pair<std::string, std::string>> links) {
  Json to = Json::array();
  for (auto& [words, id] : links) to.push_back({{"words", std::move(words)}, {"to", std::move(id)}});
  json_["verdict"] = {{"sentence", std::move(sentence)}, {"more", std::move(more)}, {"links", std::move(to)}};
}

void View::fact(std::string name, std::string value) {
  json_["facts"].push_back({{"name", std::move(name)}, {"value", sim::printable(value, kLongestText)}});
}

void View::notice(std::string words) { json_["notices"].push_back(sim::printable(words, kLongestText)); }

void View::headline(const Headline& figure) {
  json_["headlines"].push_back({{"id", figure.id},
                                {"name", figure.name},
                                {"value", figure.value},
                                {"show", name_of(figure.show)},
                                {"unit", figure.unit},
                                {"low", figure.low},
                                {"high", figure.high},
                                {"note", figure.note}});
}

const Json& at(const Json& json, std::initializer_list<std::string_view> keys) {
  static const Json kNothing{};
  const Json* found = &json;
  for (const std::string_view key : keys) {
    if (!found->is_object()) return kNothing;
    const auto next = found->find(key);
    if (next == found->end()) return kNothing;
    found = &*next;
  }
  return *found;
}

double number_at(const Json& json, std::initializer_list<std::string_view> keys, double otherwise) {
  const Json& found = at(json, keys);
  return found.is_number() ? found.get<double>() : otherwise;
}

std::string text_at(const Json& json, std::initializer_list<std::string_view> keys) {
  const Json& found = at(json, keys);
  return found.is_string() ? sim::printable(found.get<std::string>(), kLongestText) : std::string();
}

std::string number_text(double value) {
  return std::abs(value) >= kWhole ? sim::si_text(value) : fmt::format("{:.4g}", value);
}

std::string counted(double count, std::string_view one) {
  return fmt::format("{} {}{}", sim::si_text(count), one, count == 1 ? "" : "s");
}

std::string percent_text(double share) {
  const double percent = 100 * share;
  return fmt::format("{:.{}f} %", percent, std::abs(percent) < 10 ? 2 : 1);
}

}  // namespace tools::pages
