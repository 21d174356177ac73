#include "tools/studies/report/page/specs.h"

#include "tools/studies/report/page/colours.h"

namespace tools::pages {
namespace {

constexpr int kBar = 22;          ///< height of a bar's band, in pixels
constexpr int kToMiddle = 3;      ///< from where texts of bars side by side stand to the middle of their bar
constexpr double kNamed = 0.055;  ///< least share of a part that is named in its bar

/// Metric prefixes, but none for zero.
Json prefixed() { return {{"format", "~s"}, {"labelExpr", "datum.value == 0 ? '0' : datum.label"}}; }

/// As percent_text() has them.
Json percents(const std::string& format) {
  return {{"format", format}, {"labelExpr", "replace(datum.label, '%', ' %')"}};
}

/// Labels of an axis in a format of D3: "~s" for metric prefixes.
Json labels(const std::string& format) {
  if (format.ends_with('%')) return percents(format);
  return format == "~s" ? prefixed() : Json{{"format", format}};
}

/// Says to the page's scripts that names and labels of bars may stand above them where there is no room beside them.
/// `first` is 0 in one part of each bar, where it has several.
Json rows_of(const std::string& name, const std::string& label, const std::string& first = {}) {
  Json rows = {{"name", name}};
  if (!label.empty()) rows["label"] = label;
  if (!first.empty()) rows["first"] = first;
  return {{"rows", std::move(rows)}};
}

Json field(const std::string& name, const char* type, const std::string& title, const std::string& format = {}) {
  Json out = {{"field", name}, {"type", type}, {"title", title}};
  if (!format.empty()) out["axis"] = labels(format);
  return out;
}

Json ordered(const Axis& category) {
  return {{"field", category.field},
          {"type", "nominal"},
          {"title", nullptr},
          {"sort", nullptr},
          {"axis", {{"labelLimit", 250}, {"ticks", false}, {"domain", false}}}};
}

Json scale_of(const Colours& colours) {
  Json domain = Json::array(), range = Json::array();
  for (const auto& [name, colour] : colours) {
    domain.push_back(name);
    range.push_back(colour);
  }
  return {{"domain", std::move(domain)}, {"range", std::move(range)}};
}

}  // namespace

Json bars_spec(const Axis& category, const Axis& value, const std::string& label_field, double from) {
  Json x = field(value.field, "quantitative", value.title, value.format);
  x["scale"] = {{"zero", from == 0}, {"nice", true}};
  if (from != 0) x["scale"]["domainMin"] = from;
  return {{"width", "container"},
          {"height", {{"step", kBar}}},
          {"usermeta", rows_of(category.field, label_field)},
          {"encoding", {{"y", ordered(category)}, {"x", std::move(x)}}},
          {"layer",
           {{{"mark", {{"type", "bar"}, {"color", colours::kAccent}, {"height", {{"band", 0.62}}}}},
             {"encoding",
              {{"x2", {{"datum", from}}},
               {"tooltip",
                {{{"field", category.field}, {"title", " "}}, {{"field", label_field}, {"title", value.title}}}}}}},
            {{"mark", {{"type", "text"}, {"align", "left"}, {"dx", 5}, {"color", colours::kText}}},
             {"encoding", {{"text", {{"field", label_field}}}}}}}}};
}

Json stack_spec(const Axis& category, const std::string& part, const std::string& share, const Colours& colours) {
  const Json tooltip = {{{"field", category.field}, {"title", category.title.empty() ? " " : category.title}},
                        {{"field", part}, {"title", "part"}},
                        {{"field", share}, {"title", "share"}, {"format", ".2%"}},
                        {{"field", "meaning"}, {"title", "meaning"}}};
  const Json colour = {
      {"field", part},
      {"type", "nominal"},
      {"title", nullptr},
      {"sort", nullptr},
      {"scale", scale_of(colours)},
      {"legend", {{"orient", "bottom"}, {"columns", 6}, {"symbolType", "square"}, {"labelLimit", 220}}}};
  const Json x = {{"field", share},  {"type", "quantitative"},        {"title", nullptr},
                  {"stack", "zero"}, {"scale", {{"domain", {0, 1}}}}, {"axis", percents(".0%")}};
  Json middle = x;
  middle["bandPosition"] = 0.5;
  const Json order = {{"field", "order"}, {"type", "quantitative"}};
  return {
      {"width", "container"},
      {"height", {{"step", kBar + 6}}},
      {"usermeta", rows_of(category.field, "", "order")},
      {"encoding", {{"y", ordered(category)}, {"order", order}}},
      {"layer",
       {{{"mark", {{"type", "bar"}, {"stroke", colours::kInverse}, {"strokeWidth", 0.7}, {"height", {{"band", 0.78}}}}},
         {"encoding", {{"x", x}, {"color", colour}, {"tooltip", tooltip}}}},
        {{"mark", {{"type", "text"}, {"fontSize", 10.5}, {"limit", 120}}},
         {"encoding",
          {{"x", middle},
           {"detail", {{"field", part}}},
           {"text",
            {{"condition",
              {{"test", "datum['" + share + "'] >= " + std::to_string(kNamed)}, {"field", share}, {"format", ".0%"}}},
             {"value", ""}}},
           {"color",
            {{"condition", {{"test", "datum.pale"}, {"value", colours::kText}}}, {"value", colours::kInverse}}}}}}}}};
}

Json waterfall_spec(const std::string& title, const std::string& unit, const std::string& format) {
  const Json tooltip = {{{"field", "name"}, {"title", " "}}, {{"field", "label"}, {"title", unit}}};
  const Json colour = {
      {"field", "kind"},
      {"type", "nominal"},
      {"title", nullptr},
      {"scale", {{"domain", {"total", "less", "more"}}, {"range", {colours::kRest, colours::kAccent, colours::kWait}}}},
      {"legend", {{"orient", "bottom"}, {"symbolType", "square"}}}};
  const auto x = [&](const char* name) -> Json {
    return {{"field", name},
            {"type", "quantitative"},
            {"title", title},
            {"scale", {{"zero", false}, {"nice", false}}},
            {"axis", labels(format)}};
  };
  return {{"width", "container"},
          {"height", {{"step", kBar}}},
          {"usermeta", rows_of("name", "label")},
          {"encoding", {{"y", ordered({"name", ""})}}},
          {"layer",
           {{{"mark", {{"type", "bar"}, {"height", {{"band", 0.66}}}}},
             {"encoding", {{"x", x("from")}, {"x2", {{"field", "to"}}}, {"color", colour}, {"tooltip", tooltip}}}},
            {{"mark", {{"type", "text"}, {"align", "left"}, {"dx", 5}, {"color", colours::kText}}},
             {"encoding", {{"x", x("right")}, {"text", {{"field", "label"}}}}}}}}};
}

Json lines_spec(const Axis& x, const Axis& y, const std::string& series) {
  Json encoding = {{"x", field(x.field, "quantitative", x.title, x.format)},
                   {"y", field(y.field, "quantitative", y.title, y.format)}};
  if (!series.empty()) encoding["color"] = {{"field", series}, {"type", "nominal"}, {"title", nullptr}};
  encoding["tooltip"] = {{{"field", x.field}, {"title", x.title}}, {{"field", y.field}, {"title", y.title}}};
  return {{"width", "container"},
          {"height", 180},
          {"mark", {{"type", "line"}, {"point", true}, {"color", colours::kAccent}}},
          {"encoding", std::move(encoding)}};
}

Json roofline_spec() {
  const auto axis = [](const char* name, const char* title) -> Json {
    return {{"field", name},
            {"type", "quantitative"},
            {"title", title},
            {"scale", {{"type", "log"}, {"nice", false}}},
            {"axis", {{"format", "~s"}, {"labelOverlap", true}, {"tickCount", 6}}}};
  };
  const auto only = [](const std::string& test) { return Json::array({Json{{"filter", test}}}); };
  const auto label = [&](const char* side, int dy) -> Json {
    return {{"transform", only(std::string("datum.label == '") + side + "'")},
            {"mark", {{"type", "text"}, {"align", "left"}, {"dy", dy}, {"dx", 4}, {"color", colours::kText}}},
            {"encoding", {{"text", {{"field", "name"}}}}}};
  };
  // The name of a run, on the side that has room for it, in two lines: "this run: 100 Mrays/s at 60 B a ray".
  const auto run = [&](const char* side, const char* align, int dx) -> Json {
    return {{"transform", only(std::string("datum.line == '' && datum.label == '") + side + "'")},
            {"mark",
             {{"type", "text"},
              {"align", align},
              {"dx", dx},
              {"dy", 12},
              {"lineBreak", " at "},
              {"fontWeight", 600},
              {"color", colours::kAccent}}},
            {"encoding", {{"text", {{"field", "name"}}}}}};
  };
  return {{"width", "container"},
          {"height", 300},
          {"encoding", {{"x", axis("x", "DRAM bytes per ray")}, {"y", axis("y", "rays per second")}}},
          {"layer",
           {{{"transform", only("datum.line != ''")},
             {"mark", {{"type", "line"}, {"color", colours::kRest}, {"strokeWidth", 1.6}}},
             {"encoding", {{"detail", {{"field", "line"}}}, {"order", {{"field", "x"}}}}}},
            label("above", -7),
            label("below", 13),
            {{"transform", only("datum.line == ''")},
             {"mark", {{"type", "point"}, {"filled", true}, {"size", 90}, {"color", colours::kAccent}, {"opacity", 1}}},
             {"encoding",
              {{"tooltip",
                {{{"field", "name"}, {"title", " "}},
                 {{"field", "x"}, {"title", "bytes per ray"}, {"format", ".4s"}},
                 {{"field", "y"}, {"title", "rays/s"}, {"format", ".4s"}}}}}}},
            run("before", "left", 9),
            run("behind", "right", -9)}}};
}

Json series_spec(const std::vector<std::string>& names, const std::string& unit, bool stacked, const Colours& colours) {
  Json y = {{"field", "value"}, {"type", "quantitative"}, {"title", unit}, {"axis", {{"tickCount", 5}}}};
  y["stack"] = stacked ? Json("zero") : Json();
  const Json mark = stacked ? Json{{"type", "area"}, {"interpolate", "step-after"}}
                            : Json{{"type", "line"}, {"interpolate", "step-after"}, {"strokeWidth", 1.5}};
  return {{"width", "container"},
          {"height", 220},
          {"transform", Json::array({Json{{"fold", names}, {"as", {"name", "value"}}}})},
          {"mark", mark},
          {"encoding",
           {{"x",
             {{"field", "begin_us"},
              {"type", "quantitative"},
              {"title", "us of simulated time"},
              {"scale", {{"nice", false}}}}},
            {"y", std::move(y)},
            {"color",
             {{"field", "name"},
              {"type", "nominal"},
              {"title", nullptr},
              {"sort", nullptr},
              {"scale", colours.empty() ? Json{{"domain", names}} : scale_of(colours)},
              {"legend", {{"orient", "bottom"}, {"columns", 6}, {"symbolType", "square"}}}}}}}};
}

Json sensitivity_spec() {
  const auto share = [](const char* name) -> Json {
    return {{"field", name},
            {"type", "quantitative"},
            {"title", "share of variance"},
            {"scale", {{"domain", {0, 1}}}},
            {"axis", percents(".0%")}};
  };
  Json y = ordered({"metric", ""});
  y["axis"]["labelLimit"] = 160;
  const Json offset = {{"field", "axis"}, {"type", "nominal"}, {"sort", nullptr}};
  // Behind an interval there is room for its label, or before it within the bar.
  const std::string is_long = "datum.high > 0.85 && datum.low > 0.25";
  const auto label = [&](const std::string& test, const char* end, const char* align, const char* colour) -> Json {
    return {
        {"transform", Json::array({Json{{"filter", test}}})},
        {"mark",
         {{"type", "text"}, {"align", align}, {"dx", align[0] == 'l' ? 5 : -5}, {"color", colour}, {"dy", kToMiddle}}},
        {"encoding", {{"x", share(end)}, {"text", {{"field", "label"}}}}}};
  };
  return {{"width", "container"},
          {"height", {{"step", 15}}},
          {"encoding", {{"y", std::move(y)}, {"yOffset", offset}}},
          {"layer",
           {{{"mark", {{"type", "bar"}, {"height", {{"band", 0.8}}}}},
             {"encoding",
              {{"x", share("share")},
               {"color",
                {{"field", "axis"},
                 {"type", "nominal"},
                 {"title", nullptr},
                 {"sort", nullptr},
                 {"legend", {{"orient", "bottom"}, {"symbolType", "square"}, {"labelLimit", 260}}}}},
               {"tooltip",
                {{{"field", "metric"}, {"title", "figure"}},
                 {{"field", "axis"}, {"title", "axis"}},
                 {{"field", "share"}, {"title", "share"}, {"format", ".1%"}}}}}}},
            {{"mark", {{"type", "rule"}, {"color", colours::kText}}},
             {"encoding", {{"x", share("low")}, {"x2", {{"field", "high"}}}}}},
            label("!(" + is_long + ")", "high", "left", colours::kText),
            label(is_long, "low", "right", colours::kInverse)}}};
}

}  // namespace tools::pages
