#include "tools/studies/sweep/spec/axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/config/config.h"
#include "sim/config/config_tree.h"
#include "sim/io/printable.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/sweep/spec/magnitude.h"

namespace tools::sweep {
namespace {

constexpr std::size_t kMostAxes = 64, kMostValues = 10'000, kMostKeys = 64, kMostSettings = 1'000'000;

/// "8 KiB" as 8 and " KiB".
struct Number {
  double value = 0;
  std::string unit;
};

Number read_number(const YamlValue& value) {
  const std::string& text = value.text();
  std::size_t end = text.find_first_not_of("0123456789.+-eE");
  // An 'e' that begins a unit is none of the number's; no unit begins with one.
  end = std::min(end, text.size());
  Number number{0, text.substr(end)};
  try {
    std::size_t read = 0;
    number.value = std::stod(text.substr(0, end), &read);
    if (read != end || !std::isfinite(number.value)) throw std::invalid_argument(text);
  } catch (const std::logic_error&) {
    value.refuse(fmt::format("'{}' is no number with or without unit", sim::printable(text)));
  }
  return number;
}

/// The number in another unit of its kind; none if the units are of two kinds.
std::optional<Number> convert(const Number& number, const std::string& unit) {
  if (number.unit == unit) return number;
  const std::optional<Magnitude> one = magnitude_of("1" + number.unit), other = magnitude_of("1" + unit);
  if (!one || !other || one->kind != other->kind) return std::nullopt;
  return Number{number.value * one->value / other->value, unit};
}

bool is_whole(const std::string& key) {
  for (const sim::FieldInfo& field : sim::list_fields(RunConfig())) {
    if (field.path != key) continue;
    return field.kind == sim::FieldKind::kUint32 || field.kind == sim::FieldKind::kUint64 ||
           field.kind == sim::FieldKind::kAutoCount;
  }
  return false;
}

/// {from, to, step | count | factor, scale}
class Range {
 public:
  explicit Range(const YamlValue& value) : value_(value) {
    for (const YamlValue& entry : value.entries()) {
      if (entry.key() == "count") {
        count_ = entry.whole_number(1, kMostValues);
      } else if (entry.key() == "scale") {
        if (entry.text() != "log" && entry.text() != "linear") entry.refuse("allowed: linear, log");
        log_ = entry.text() == "log";
      } else if (entry.key() != "keys") {
        numbers_[entry.key()] = read_number(entry);
      }
    }
    if (!numbers_.contains("from") || !numbers_.contains("to")) value.refuse("allowed: both from and to");
    if (numbers_.contains("step") + numbers_.contains("factor") + count_.has_value() != 1) {
      value.refuse("allowed: one of step, factor and count");
    }
    if (log_ && !count_) value.refuse("allowed: scale with count");
    for (const char* name : {"to", "step"}) {
      if (!numbers_.contains(name)) continue;
      const std::optional<Number> converted = convert(numbers_[name], numbers_["from"].unit);
      if (!converted) value.refuse("allowed: from, to and step in units of one kind, e.g. 128 KiB and 1 MiB");
      numbers_[name] = *converted;
    }
  }

  std::vector<std::string> texts(bool whole) {
    const double from = numbers_["from"].value, to = numbers_["to"].value;
    std::vector<std::string> all;
    const auto add = [&](double number) {
      // Fewer digits than the host has: rounded alike on all.
      const std::string shown = whole  ? fmt::format("{:.0f}", number)
                                : log_ ? fmt::format("{:.6g}", number)
                                       : fmt::format("{:.12g}", number);
      const std::string text = shown + numbers_["from"].unit;
      if (!all.empty() && all.back() == text) {
        if (!whole) value_.refuse(fmt::format("has '{}' twice: its values are too close to each other", text));
        return;
      }
      all.push_back(text);
      if (all.size() > kMostValues) value_.refuse(fmt::format("has more than {} values", kMostValues));
    };
    const double slack = 1 + 1e-9;
    if (numbers_.contains("step")) {
      const double step = numbers_["step"].value;
      if (step == 0 || (to - from) / step < 0) value_.refuse("the step does not lead from 'from' to 'to'");
      const double steps = std::floor((to - from) / step * slack);
      if (steps >= kMostValues) value_.refuse(fmt::format("has more than {} values", kMostValues));
      for (double k = 0; k <= steps; ++k) add(from + k * step);
    } else if (numbers_.contains("factor")) {
      const double factor = numbers_["factor"].value;
      if (!(from > 0 && to >= from && factor >= 1.0001)) {
        value_.refuse("allowed: a factor above 1, and 'from' above 0 and not above 'to'");
      }
      for (double number = from; number <= to * slack && std::isfinite(number); number *= factor) add(number);
    } else {
      if (log_ && !(from > 0 && to > 0)) value_.refuse("allowed: 'from' and 'to' above 0 on a log scale");
      const auto last = static_cast<double>(*count_ - 1);
      for (double k = 0; k <= last; ++k) {
        const double share = last == 0 ? 0 : k / last;
        add(log_ ? from * std::pow(to / from, share) : from + (to - from) * share);
      }
    }
    return all;
  }

 private:
  const YamlValue& value_;
  std::map<std::string, Number> numbers_;
  std::optional<std::uint64_t> count_;
  bool log_ = false;
};

/// A value for each key: a list of them, or one for all.
Axis::Value read_row(const YamlValue& value, const Axis& axis) {
  Axis::Value row;
  if (value.is_list()) {
    row.settings = value.texts();
    if (row.settings.size() != axis.keys.size()) {
      value.refuse(fmt::format("has {} values for {} keys ({})", row.settings.size(), axis.keys.size(),
                               fmt::join(axis.keys, ", ")));
    }
    row.label = fmt::format("{}", fmt::join(row.settings, " / "));
  } else {
    row.settings.assign(axis.keys.size(), value.text());
    row.label = value.text();
  }
  return row;
}

/// [a, b], [[a, b], [c, d]], or {name: a} or {name: [a, b]}.
void read_values(const YamlValue& value, Axis& axis) {
  const bool named = value.is_mapping();
  for (const YamlValue& item : named ? value.entries() : value.items()) {
    axis.values.push_back(read_row(item, axis));
    if (named) axis.values.back().label = item.key();
  }
}

void check_values(const YamlValue& value, const Axis& axis) {
  if (axis.values.empty()) value.refuse("has no values");
  if (axis.values.size() > kMostValues) value.refuse(fmt::format("has more than {} values", kMostValues));
  std::vector<std::string> labels;
  for (const Axis::Value& v : axis.values) labels.push_back(v.label);
  std::ranges::sort(labels);
  const auto twice = std::ranges::adjacent_find(labels);
  if (twice != labels.end()) value.refuse(fmt::format("has '{}' twice", sim::printable(*twice)));
}

/// A name that tables of results have for something else.
bool is_column(const std::string& name) {
  constexpr std::array<std::string_view, 4> kOwn = {"n", "id", "status", "error"};
  constexpr std::array<std::string_view, 4> kOfReports = {"totals.", "units.", "frames[", "config."};
  return std::ranges::find(kOwn, name) != kOwn.end() ||
         std::ranges::any_of(kOfReports, [&](std::string_view group) { return name.starts_with(group); });
}

}  // namespace

Axis read_list(const std::string& key, const YamlValue& value) {
  Axis axis{key, value.where(), {key}, {}};
  read_values(value, axis);
  check_values(value, axis);
  return axis;
}

Axis read_axis(const YamlValue& value) {
  if (value.is_list()) return read_list(value.key(), value);
  constexpr std::array<std::string_view, 8> kKeys = {"keys", "values", "from",  "to",
                                                     "step", "factor", "count", "scale"};
  Axis axis{value.key(), value.where(), {value.key()}, {}};
  std::optional<YamlValue> values;
  for (const YamlValue& entry : value.entries(kKeys)) {
    if (entry.key() == "keys") axis.keys = entry.texts();
    if (axis.keys.size() > kMostKeys) entry.refuse(fmt::format("are more than {}", kMostKeys));
    if (entry.key() == "values") values = entry;
  }
  if (values) {
    constexpr std::array<std::string_view, 2> kOfLists = {"keys", "values"};
    value.entries(kOfLists);
    read_values(*values, axis);
  } else {
    for (const std::string& text : Range(value).texts(is_whole(axis.keys.front()))) {
      axis.values.push_back({text, std::vector<std::string>(axis.keys.size(), text)});
    }
  }
  check_values(value, axis);
  return axis;
}

Axis read_workloads(const YamlValue& value) {
  constexpr std::array<std::string_view, 5> kKeys = {"name", "scene", "camera", "frames", "resolution"};
  Axis axis{"workload", value.where(), {"scene", "camera", "frames", "resolution"}, {}};
  for (const YamlValue& item : value.items()) {
    Axis::Value workload{{}, std::vector<std::string>(axis.keys.size())};
    if (item.is_text()) {
      workload.label = workload.settings[0] = item.text();
    } else {
      for (const YamlValue& entry : item.entries(kKeys)) {
        const auto key = std::ranges::find(axis.keys, entry.key());
        if (key == axis.keys.end()) {
          workload.label = entry.text();
        } else {
          workload.settings[static_cast<std::size_t>(key - axis.keys.begin())] = entry.text();
        }
      }
      if (workload.settings[0].empty()) item.refuse("has no scene");
      if (workload.label.empty()) {
        std::vector<std::string> parts = workload.settings;
        std::erase(parts, "");
        workload.label = fmt::format("{}", fmt::join(parts, " "));
      }
    }
    axis.values.push_back(std::move(workload));
  }
  check_values(value, axis);
  return axis;
}

void check_axes(std::span<const Axis> axes) {
  if (axes.size() > kMostAxes) sim::refuse(axes[kMostAxes].at, "axes", fmt::format("are more than {}", kMostAxes));
  std::map<std::string, std::string> owners, names;
  std::size_t settings = 0;
  for (const Axis& axis : axes) {
    settings += axis.values.size() * axis.keys.size();
    if (settings > kMostSettings) sim::refuse(axis.at, "axes", fmt::format("have more than {} values", kMostSettings));
    if (!names.emplace(axis.name, axis.name).second) sim::refuse(axis.at, axis.name, "is the name of two axes");
    if (is_column(axis.name)) sim::refuse(axis.at, axis.name, "is the name of a column of results; choose another");
    for (const std::string& key : axis.keys) {
      const auto [owner, is_new] = owners.emplace(key, axis.name);
      if (!is_new) {
        sim::refuse(axis.at, axis.name,
                    fmt::format("moves '{}', which '{}' moves already", sim::printable(key), owner->second));
      }
    }
  }
}

}  // namespace tools::sweep
