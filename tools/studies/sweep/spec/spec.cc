#include "tools/studies/sweep/spec/spec.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "sim/config/config_tree.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/run/frame/job_options.h"
#include "tools/run/frame/load_config.h"
#include "tools/sampling/frame_sample.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/studies/sweep/spec/set_metric.h"
#include "traces/scene/did_you_mean.h"

namespace tools::sweep {
namespace {

constexpr std::size_t kMostItems = 10'000;  // a hostile file can repeat one list many times by YAML aliases
constexpr std::size_t kMostAxes = 64, kMostValues = 10'000, kMostKeys = 64, kMostSettings = 1'000'000;
constexpr std::uint64_t kMostSpecBytes = 1 << 20;
constexpr std::string_view kSpecSchema = "raywatt-sweep/1";
constexpr std::uint64_t kMostSlices = 10'000;
constexpr std::array<std::pair<std::string_view, std::string Spec::*>, 4> kTextKeys = {
    {{"question", &Spec::question}, {"config", &Spec::config}, {"scene", &Spec::scene}, {"camera", &Spec::camera}}};
constexpr std::array<std::string_view, 22> kSpecKeys = {
    "schema",  "question",  "config",        "sets",       "scene", "camera",        "frames", "resolution",
    "program", "reference", "workloads",     "programs",   "axes",  "exclude",       "where",  "subset",
    "image",   "slices",    "tile_sampling", "replicates", "slurm", "representative"};

}  // namespace

std::string YamlValue::where() const { return fmt::format("{}:{}:{}", file_, at_.line, at_.column); }

void YamlValue::refuse(std::string_view problem) const { sim::refuse(where(), path_, problem); }

const std::string& YamlValue::text() const {
  if (!is_text() || node_->scalar.empty()) refuse("allowed: one value");
  return node_->scalar;
}

std::uint64_t YamlValue::whole_number(std::uint64_t least, std::uint64_t most) const {
  const std::string& digits = text();
  std::uint64_t number = 0;
  const auto [end, bad] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (bad != std::errc{} || end != digits.data() + digits.size() || number < least || number > most) {
    refuse(
        fmt::format("'{}' is not allowed; allowed: a whole number from {} to {}", sim::printable(digits), least, most));
  }
  return number;
}

bool YamlValue::boolean() const {
  const std::string& word = text();
  if (word == "yes" || word == "true") return true;
  if (word != "no" && word != "false")
    refuse(fmt::format("'{}' is not allowed; allowed: yes, no", sim::printable(word)));
  return false;
}

std::vector<YamlValue> YamlValue::items() const {
  if (!is_list()) refuse("allowed: a list, such as [1, 2, 4]");
  if (node_->entries.empty()) refuse("is empty");
  if (node_->entries.size() > kMostItems) refuse(fmt::format("has more than {} items", kMostItems));
  std::vector<YamlValue> all;
  for (const sim::YamlNode::Entry& item : node_->entries) all.push_back(YamlValue(*this, item, path_));
  return all;
}

std::vector<std::string> YamlValue::list_of_texts() const {
  std::vector<std::string> all;
  for (const YamlValue& item : items()) all.push_back(item.text());
  return all;
}

std::vector<YamlValue> YamlValue::entries() const {
  if (!is_mapping()) refuse("allowed: a mapping, such as {key: value}");
  if (node_->entries.size() > kMostItems) refuse(fmt::format("has more than {} entries", kMostItems));
  std::vector<YamlValue> all;
  for (const sim::YamlNode::Entry& entry : node_->entries) {
    const std::string key = sim::printable(entry.key);
    all.push_back(YamlValue(*this, entry, path_.empty() ? key : path_ + "." + key));
  }
  return all;
}

std::vector<YamlValue> YamlValue::entries(std::span<const std::string_view> keys) const {
  std::vector<YamlValue> all = entries();
  for (const YamlValue& entry : all) {
    if (std::ranges::find(keys, entry.key()) != keys.end()) continue;
    sim::refuse(fmt::format("{}:{}:{}", file_, entry.key_at_.line, entry.key_at_.column), entry.path_,
                fmt::format("unknown key '{}'{}; allowed: {}", sim::printable(entry.key()),
                            traces::did_you_mean(entry.key(), std::vector<std::string>(keys.begin(), keys.end())),
                            fmt::join(keys, ", ")));
  }
  return all;
}

namespace {

/// A number and its unit: "8 KiB" is 8 and " KiB".
struct Number {
  double value = 0;
  std::string unit;
};

Number read_number(const YamlValue& value) {
  const std::string& text = value.text();
  std::size_t end = text.find_first_not_of("0123456789.+-eE");
  // No unit begins with "e", so the exponent is no unit.
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

/// Converts a number to another unit; nothing if the units are of different kinds.
std::optional<Number> convert_unit(const Number& number, const std::string& unit) {
  if (number.unit == unit) return number;
  const std::optional<Magnitude> one = parse_magnitude("1" + number.unit), other = parse_magnitude("1" + unit);
  if (!one || !other || one->kind != other->kind) return std::nullopt;
  return Number{number.value * one->value / other->value, unit};
}

/// True for a key of the configuration that takes whole numbers.
bool is_whole_number_key(const std::string& key) {
  for (const sim::FieldInfo& field : sim::list_fields(RunConfig())) {
    if (field.path != key) continue;
    return field.kind == sim::FieldKind::kUint32 || field.kind == sim::FieldKind::kUint64 ||
           field.kind == sim::FieldKind::kAutoCount;
  }
  return false;
}

/// The values of an axis written as a range: {from, to, step | count | factor, scale}.
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
      const std::optional<Number> converted = convert_unit(numbers_[name], numbers_["from"].unit);
      if (!converted) value.refuse("allowed: from, to and step in units of one kind, e.g. 128 KiB and 1 MiB");
      numbers_[name] = *converted;
    }
  }

  std::vector<std::string> list_values(bool whole) {
    const double from = numbers_["from"].value, to = numbers_["to"].value;
    std::vector<std::string> all;
    const auto add = [&](double number) {
      // Fewer digits than a double has, so that the text is the same on all hosts.
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

/// Reads one value of an axis: a list with a setting for each key, or one setting for all keys.
Axis::Value read_row(const YamlValue& value, const Axis& axis) {
  Axis::Value row;
  if (value.is_list()) {
    row.settings = value.list_of_texts();
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

/// Reads the values of an axis in one of the forms [a, b], [[a, b], [c, d]], {name: a} or {name: [a, b]}.
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

/// True if an axis may not have this name because tables of results have another column of this name.
bool is_column(const std::string& name) {
  constexpr std::array<std::string_view, 4> kOwn = {"n", "id", "status", "error"};
  constexpr std::array<std::string_view, 4> kOfReports = {"totals.", "units.", "frames[", "config."};
  return std::ranges::find(kOwn, name) != kOwn.end() ||
         std::ranges::any_of(kOfReports, [&](std::string_view group) { return name.starts_with(group); });
}

/// Reads an axis of one configuration key from a YAML list of values.
Axis read_list(const std::string& key, const YamlValue& value) {
  Axis axis{key, value.where(), {key}, {}};
  read_values(value, axis);
  check_values(value, axis);
  return axis;
}

/// Reads an axis in one of the forms KEY: [values], KEY: {from, to, step | count | factor, scale} or NAME: {keys:
/// [...], values: ...}.
Axis read_axis(const YamlValue& value) {
  if (value.is_list()) return read_list(value.key(), value);
  constexpr std::array<std::string_view, 8> kKeys = {"keys", "values", "from",  "to",
                                                     "step", "factor", "count", "scale"};
  Axis axis{value.key(), value.where(), {value.key()}, {}};
  std::optional<YamlValue> values;
  for (const YamlValue& entry : value.entries(kKeys)) {
    if (entry.key() == "keys") axis.keys = entry.list_of_texts();
    if (axis.keys.size() > kMostKeys) entry.refuse(fmt::format("are more than {}", kMostKeys));
    if (entry.key() == "values") values = entry;
  }
  if (values) {
    constexpr std::array<std::string_view, 2> kOfLists = {"keys", "values"};
    value.entries(kOfLists);
    read_values(*values, axis);
  } else {
    for (const std::string& text : Range(value).list_values(is_whole_number_key(axis.keys.front()))) {
      axis.values.push_back({text, std::vector<std::string>(axis.keys.size(), text)});
    }
  }
  check_values(value, axis);
  return axis;
}

/// Reads the axis `workload` from a list of workloads: scenes, each with optional camera, frames and resolution.
Axis read_workloads(const YamlValue& value) {
  constexpr std::array<std::string_view, 5> kKeys = {"name", "scene", "camera", "frames", "resolution"};
  Axis axis{std::string(kWorkloadAxis), value.where(), {"scene", "camera", "frames", "resolution"}, {}};
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

/// Throws InputError if two axes set the same key or have the same name, or if there are too many axes.
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

constexpr std::size_t kMostConditionValues = 100'000;  // a hostile file can name one list in many places

/// Finds an axis by its name or one of its keys.
std::optional<AxisCondition::Side> find_side(std::span<const Axis> axes, const std::string& name) {
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].name == name) {
      return AxisCondition::Side{a, axes[a].keys.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt};
    }
    const auto key = std::ranges::find(axes[a].keys, name);
    if (key != axes[a].keys.end()) {
      return AxisCondition::Side{a, static_cast<std::size_t>(key - axes[a].keys.begin())};
    }
  }
  return std::nullopt;
}

std::vector<std::string> names_of(std::span<const Axis> axes) {
  std::vector<std::string> names;
  for (const Axis& axis : axes) {
    names.push_back(axis.name);
    for (const std::string& key : axis.keys) {
      if (key != axis.name) names.push_back(key);
    }
  }
  return names;
}

/// Reads one entry of a condition: AXIS: VALUE, AXIS: [VALUES], AXIS: "< VALUE" or AXIS: ">= AXIS".
AxisCondition::Term read_term(const YamlValue& value, std::span<const Axis> axes) {
  const std::optional<AxisCondition::Side> left = find_side(axes, value.key());
  if (!left) {
    value.refuse(fmt::format("'{}' is no axis{}", sim::printable(value.key()),
                             traces::did_you_mean(value.key(), names_of(axes))));
  }
  AxisCondition::Term term;
  term.left = *left;
  term.at = value.where();
  if (value.is_list()) {
    for (std::string& text : value.list_of_texts()) term.values.emplace_back(std::move(text));
    return term;
  }
  auto [comparison, right] = parse_comparison(value.text());
  if (right.empty()) value.refuse("has nothing to compare with");
  term.comparison = comparison;
  term.right = find_side(axes, right);
  if (!term.right) term.values.emplace_back(std::move(right));
  return term;
}

/// Makes the comparison operands for the values of axes. Conditions on the same axis share them.
class AxisOperands {
 public:
  explicit AxisOperands(std::span<const Axis> axes) : axes_(axes) {}

  AxisCondition::Operands operands_of(const AxisCondition::Side& side) {
    const auto [at, is_new] = known_.try_emplace({side.axis, side.key});
    if (is_new) {
      std::vector<Operand> all;
      for (const Axis::Value& value : axes_[side.axis].values) {
        all.emplace_back(side.key ? value.settings[*side.key] : value.label);
      }
      at->second = std::make_shared<const std::vector<Operand>>(std::move(all));
    }
    return at->second;
  }

 private:
  std::span<const Axis> axes_;
  std::map<std::pair<std::size_t, std::optional<std::size_t>>, AxisCondition::Operands> known_;
};

/// Reads conditions in the form [{AXIS: VALUE, ...}, ...]. Comparisons with values are evaluated once, for each value
/// of the axis.
std::vector<AxisCondition> read_conditions(const YamlValue& value, std::span<const Axis> axes) {
  std::vector<AxisCondition> all;
  std::size_t values = 0;
  AxisOperands operands(axes);
  for (const YamlValue& item : value.items()) {
    AxisCondition condition;
    for (const YamlValue& entry : item.entries()) {
      AxisCondition::Term& term = condition.terms.emplace_back(read_term(entry, axes));
      term.lefts = operands.operands_of(term.left);
      if (term.right) {
        term.rights = operands.operands_of(*term.right);
      } else {
        for (const Operand& left : *term.lefts) term.outcomes.push_back(outcome_of(term, left, term.values));
      }
      values += term.values.size() + 1;
      if (values > kMostConditionValues)
        entry.refuse(fmt::format("there are more than {} values in conditions", kMostConditionValues));
    }
    if (condition.terms.empty()) item.refuse("is empty");
    all.push_back(std::move(condition));
  }
  return all;
}

Subset read_subset(const YamlValue& value) {
  constexpr std::array<std::string_view, 3> kKinds = {"random", "latin_hypercube", "sobol"};
  constexpr std::array<std::string_view, 4> kSubsetKeys = {"random", "latin_hypercube", "sobol", "seed"};
  Subset subset;
  if (value.is_text()) {
    if (value.text() != "grid") value.refuse("allowed: grid, or {random: N}, {latin_hypercube: N}, {sobol: N}");
    return subset;
  }
  for (const YamlValue& entry : value.entries(kSubsetKeys)) {
    const auto kind = std::ranges::find(kKinds, entry.key());
    if (kind == kKinds.end()) {
      subset.seed = entry.whole_number(0, ~std::uint64_t{0});
    } else if (subset.kind != Subset::Kind::kGrid) {
      entry.refuse("allowed: one of random, latin_hypercube, sobol");
    } else {
      subset.kind = static_cast<Subset::Kind>(kind - kKinds.begin() + 1);
      subset.count = entry.whole_number(1, kMostPoints);
    }
  }
  if (subset.kind == Subset::Kind::kGrid)
    value.refuse("allowed: grid, or {random: N}, {latin_hypercube: N}, {sobol: N}");
  return subset;
}

/// Returns the text of a YAML value. Throws InputError with the value's position if `parse` refuses the text.
std::string parsable_text(const YamlValue& value, auto&& parse) {
  try {
    parse(value.text());
  } catch (const sim::InputError& error) {
    value.refuse(error.what());
  }
  return value.text();
}

void read_axes(const YamlValue& entry, std::vector<Axis>& axes) {
  for (const YamlValue& axis : entry.entries()) {
    axes.push_back(read_axis(axis));
    check_axes(axes);
  }
}

}  // namespace

bool is_work_key(const std::string& key) {
  constexpr std::array<std::string_view, 5> kWorkKeys = {"scene", "camera", "frames", "resolution", "program"};
  return std::ranges::find(kWorkKeys, key) != kWorkKeys.end();
}

bool changes_workload(const Axis& axis) {
  const auto is_of_workload = [](const std::string& key) {
    return (is_work_key(key) && key != "program") || key.starts_with("scene.") || key == "render.width" ||
           key == "render.height";
  };
  return std::ranges::any_of(axis.keys, is_of_workload);
}

Spec read_spec(const std::filesystem::path& file) {
  const std::string name = sim::printable(file.string());
  const auto tree = sim::parse_yaml_mapping(sim::read_file(file, kMostSpecBytes), name);
  return read_spec(YamlValue(*tree, name), kSpecSchema, {});
}

namespace {

/// Throws InputError for a file with another schema, before its keys are checked.
void check_schema(const YamlValue& root, std::string_view schema) {
  const auto entries = root.entries();
  const auto found = std::ranges::find(entries, "schema", &YamlValue::key);
  if (found == entries.end()) root.refuse(fmt::format("the first line shall be 'schema: {}'", schema));
  const std::string& given = found->text();
  if (given == schema) return;
  const bool is_sweep = given == kSpecSchema, is_search = given.starts_with("raywatt-optimise/");
  found->refuse(fmt::format("allowed: {}{}", schema,
                            is_sweep    ? "; a sweep is run by raywatt sweep run"
                            : is_search ? "; a search is run by raywatt optimise"
                                        : ""));
}

/// Throws InputError for a random subset of a sweep that lists workloads. Each machine would render other workloads, so
/// machines could not be compared.
void check_subset(const Spec& spec) {
  if (spec.subset.kind == Subset::Kind::kGrid) return;
  const Axis *workload = nullptr, *machine = nullptr;
  for (const Axis& axis : spec.axes) {
    if (axis.values.size() > 1) (changes_workload(axis) ? workload : machine) = &axis;
  }
  if (workload == nullptr || machine == nullptr) return;
  sim::refuse(spec.key_positions.at("subset"), "subset",
              fmt::format("draws '{}' and '{}' together, so machines would render different workloads; allowed: grid, "
                          "or one workload",
                          sim::printable(workload->name), sim::printable(machine->name)));
}

/// Refuses a key of the work, such as the scene, that every value of an axis overrides. `allows_work_axes`: false if
/// the caller refuses axes that change the workload.
void check_overridden_keys(const Spec& spec, bool allows_work_axes) {
  for (const Axis& axis : spec.axes) {
    const bool is_list = axis.name == kWorkloadAxis && spec.key_positions.contains("workloads");
    if (!is_list && !allows_work_axes && changes_workload(axis)) continue;
    for (std::size_t k = 0; k < axis.keys.size(); ++k) {
      const std::string& key = axis.keys[k];
      const auto given = spec.key_positions.find(key);
      const auto overrides = [&](const Axis::Value& value) { return !value.settings[k].empty(); };
      if (!is_work_key(key) || given == spec.key_positions.end() || !std::ranges::all_of(axis.values, overrides)) {
        continue;
      }
      const bool is_program = key == "program" && spec.key_positions.contains("programs");
      const std::string by = is_list ? "workloads" : is_program ? "programs" : "axes." + sim::printable(axis.name);
      sim::refuse(
          given->second, key,
          fmt::format("has no effect, because {0} sets it at every point; allowed: {1} or {0}, not both", by, key));
    }
  }
}

}  // namespace

Spec read_spec(const YamlValue& root, std::string_view schema, std::span<const std::string_view> other_keys) {
  check_schema(root, schema);
  std::vector<std::string_view> keys(kSpecKeys.begin(), kSpecKeys.end());
  keys.insert(keys.end(), other_keys.begin(), other_keys.end());
  Spec spec;
  std::optional<Axis> workloads, programs;
  std::optional<YamlValue> exclude, where;
  for (const YamlValue& entry : root.entries(keys)) {
    const std::string& key = entry.key();
    if (std::ranges::find(other_keys, key) != other_keys.end()) continue;
    spec.key_positions[key] = entry.where();
    const auto plain = std::ranges::find(kTextKeys, key, &std::pair<std::string_view, std::string Spec::*>::first);
    if (key == "schema") continue;
    if (plain != kTextKeys.end()) {
      spec.*plain->second = entry.text();
    } else if (key == "sets") {
      spec.sets = entry.list_of_texts();
    } else if (key == "frames") {
      spec.frames = parsable_text(entry, parse_frames);
    } else if (key == "resolution") {
      spec.resolution = parsable_text(entry, parse_resolution);
    } else if (key == "program") {
      spec.program = parsable_text(entry, kernels::parse_program);
    } else if (key == "reference") {
      spec.reference = parsable_text(entry, kernels::parse_program);
    } else if (key == "tile_sampling") {
      spec.tile_sampling = parsable_text(entry, [](const std::string& text) { parse_tile_sampling(text, "full"); });
    } else if (key == "representative") {
      spec.representative = parsable_text(entry, parse_representative);
    } else if (key == "replicates") {
      spec.replicates = static_cast<std::uint32_t>(entry.whole_number(1, kMostReplicates));
    } else if (key == "slices") {
      spec.slices = static_cast<std::uint32_t>(entry.whole_number(2, kMostSlices));
    } else if (key == "image") {
      spec.image = entry.boolean();
    } else if (key == "slurm") {
      spec.slurm = entry.list_of_texts();
    } else if (key == "subset") {
      spec.subset = read_subset(entry);
    } else if (key == "workloads") {
      workloads = read_workloads(entry);
    } else if (key == "programs") {
      programs = read_list("program", entry);
    } else if (key == "axes") {
      read_axes(entry, spec.axes);
    } else {
      (key == "where" ? where : exclude) = entry;
    }
  }
  if (programs) spec.axes.insert(spec.axes.begin(), *std::move(programs));
  if (workloads) spec.axes.insert(spec.axes.begin(), *std::move(workloads));
  check_axes(spec.axes);
  check_overridden_keys(spec, schema == kSpecSchema);
  if (exclude) spec.exclude = read_conditions(*exclude, spec.axes);
  if (where) spec.where = read_conditions(*where, spec.axes);
  check_subset(spec);
  return spec;
}

}  // namespace tools::sweep
