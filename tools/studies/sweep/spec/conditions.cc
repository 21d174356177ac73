#include "tools/studies/sweep/spec/conditions.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "sim/config/config_tree.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/studies/sweep/spec/magnitude.h"
#include "traces/scene/did_you_mean.h"

namespace tools::sweep {
namespace {

using Side = Condition::Side;

constexpr std::size_t kMostConditionValues = 100'000;  // a hostile file can name one list in many places

std::optional<Side> find_side(std::span<const Axis> axes, const std::string& name) {
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].name == name) return Side{a, axes[a].keys.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt};
    const auto key = std::ranges::find(axes[a].keys, name);
    if (key != axes[a].keys.end()) return Side{a, static_cast<std::size_t>(key - axes[a].keys.begin())};
  }
  return std::nullopt;
}

const std::string& value_of(const Side& side, std::span<const Axis> axes, std::uint32_t choice) {
  const Axis::Value& value = axes[side.axis].values[choice];
  return side.key ? value.settings[*side.key] : value.label;
}

/// "<= 8 KiB" as the comparison and what is behind it; no sign means equal.
std::pair<Comparison, std::string> split(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, Comparison>, 6> kSigns = {{{"<=", Comparison::kLessEqual},
                                                                              {">=", Comparison::kGreaterEqual},
                                                                              {"!=", Comparison::kUnequal},
                                                                              {"<", Comparison::kLess},
                                                                              {">", Comparison::kGreater},
                                                                              {"=", Comparison::kEqual}}};
  for (const auto& [sign, comparison] : kSigns) {
    if (!text.starts_with(sign)) continue;
    const std::size_t begin = text.find_first_not_of(" =", sign.size());
    return {comparison, begin == std::string::npos ? "" : text.substr(begin)};
  }
  return {Comparison::kEqual, text};
}

/// A side of a comparison. Conditions are many: texts are read once.
using Operand = Condition::Operand;

Operand operand(const std::string& text) { return {text, magnitude_of(text)}; }

bool is_equal(const Operand& a, const Operand& b) {
  const std::optional<Magnitude>&x = a.magnitude, &y = b.magnitude;
  return x && y ? x->kind == y->kind && x->value == y->value : a.text == b.text;
}

bool compare(const Operand& a, Comparison comparison, const Operand& b, const std::string& at) {
  if (comparison == Comparison::kEqual) return is_equal(a, b);
  if (comparison == Comparison::kUnequal) return !is_equal(a, b);
  const std::optional<Magnitude>&x = a.magnitude, &y = b.magnitude;
  if (!x || !y || x->kind != y->kind) {
    sim::refuse(at, {},
                fmt::format("'{}' and '{}' cannot be put in order; allowed: numbers, of one unit if they have units",
                            sim::printable(a.text), sim::printable(b.text)));
  }
  switch (comparison) {
    case Comparison::kLess:
      return x->value < y->value;
    case Comparison::kLessEqual:
      return x->value <= y->value;
    case Comparison::kGreater:
      return x->value > y->value;
    default:
      return x->value >= y->value;
  }
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

Condition::Term read_term(const YamlValue& value, std::span<const Axis> axes) {
  const std::optional<Side> left = find_side(axes, value.key());
  if (!left) {
    value.refuse(fmt::format("'{}' is no axis{}", sim::printable(value.key()),
                             traces::did_you_mean(value.key(), names_of(axes))));
  }
  Condition::Term term;
  term.left = *left;
  term.at = value.where();
  if (value.is_list()) {
    term.values = value.texts();
    return term;
  }
  auto [comparison, right] = split(value.text());
  if (right.empty()) value.refuse("has nothing to compare with");
  term.comparison = comparison;
  term.right = find_side(axes, right);
  if (!term.right) term.values = {std::move(right)};
  return term;
}

std::vector<Operand> operands(const std::vector<std::string>& texts) {
  std::vector<Operand> out;
  for (const std::string& text : texts) out.push_back(operand(text));
  return out;
}

/// Does one of the term's own values compare as wanted? InputError if they cannot be compared.
bool holds_for(const Condition::Term& term, const Operand& left, std::span<const Operand> values) {
  return std::ranges::any_of(values,
                             [&](const Operand& value) { return compare(left, term.comparison, value, term.at); });
}

/// All values of axes, by number and key of the axis.
using AxisOperands = std::map<std::pair<std::size_t, std::optional<std::size_t>>, Condition::Operands>;

Condition::Operands operands_of(const Side& side, std::span<const Axis> axes, AxisOperands& known) {
  const auto [at, is_new] = known.try_emplace({side.axis, side.key});
  if (is_new) {
    std::vector<Operand> all;
    for (std::uint32_t value = 0; value < axes[side.axis].values.size(); ++value) {
      all.push_back(operand(value_of(side, axes, value)));
    }
    at->second = std::make_shared<const std::vector<Operand>>(std::move(all));
  }
  return at->second;
}

/// Reads each value of the axes once, and compares it with the term's own values, however many combinations there are.
void prepare(Condition::Term& term, std::span<const Axis> axes, AxisOperands& known) {
  term.lefts = operands_of(term.left, axes, known);
  if (term.right) {
    term.rights = operands_of(*term.right, axes, known);
    return;
  }
  const std::vector<Operand> values = operands(term.values);
  for (const Operand& left : *term.lefts) {
    try {
      term.outcomes.emplace_back(holds_for(term, left, values));
    } catch (const sim::InputError&) {  // said where a combination needs it
      term.outcomes.emplace_back();
    }
  }
}

/// Is it known, by what is on the left, whether the term holds?
bool is_known(const Condition::Term& term) {
  return !term.right && std::ranges::all_of(term.outcomes, [](const auto& outcome) { return outcome.has_value(); });
}

/// Can all values of its axes be compared?
bool always_compares(const Condition::Term& term) {
  if (!term.right) return is_known(term);
  if (term.comparison == Comparison::kEqual || term.comparison == Comparison::kUnequal) return true;
  const std::optional<Magnitude>& first = term.lefts->front().magnitude;
  const auto is_alike = [&](const Operand& value) { return value.magnitude && value.magnitude->kind == first->kind; };
  return first && std::ranges::all_of(*term.lefts, is_alike) && std::ranges::all_of(*term.rights, is_alike);
}

/// The known term that holds for the fewest values; none if there is none, or if one before it may be refused.
const Condition::Term* rarest(const Condition& condition) {
  const Condition::Term* best = nullptr;
  std::ptrdiff_t least = 0;
  for (const Condition::Term& term : condition.terms) {
    if (is_known(term)) {
      const std::ptrdiff_t values = std::ranges::count(term.outcomes, std::optional(true));
      if (best == nullptr || values < least) best = &term, least = values;
    }
    if (!always_compares(term)) break;
  }
  return best;
}

}  // namespace

std::vector<Condition> read_conditions(const YamlValue& value, std::span<const Axis> axes) {
  std::vector<Condition> all;
  std::size_t values = 0;
  AxisOperands known;
  for (const YamlValue& item : value.items()) {
    Condition condition;
    for (const YamlValue& entry : item.entries()) {
      condition.terms.push_back(read_term(entry, axes));
      prepare(condition.terms.back(), axes, known);
      values += condition.terms.back().values.size() + 1;
      if (values > kMostConditionValues)
        entry.refuse(fmt::format("there are more than {} values in conditions", kMostConditionValues));
    }
    if (condition.terms.empty()) item.refuse("is empty");
    all.push_back(std::move(condition));
  }
  return all;
}

bool holds(const Condition& condition, std::span<const std::uint32_t> choice) {
  return std::ranges::all_of(condition.terms, [&](const Condition::Term& term) {
    const std::uint32_t value = choice[term.left.axis];
    const Operand& left = (*term.lefts)[value];
    if (term.right) return compare(left, term.comparison, (*term.rights)[choice[term.right->axis]], term.at);
    return term.outcomes[value] ? *term.outcomes[value] : holds_for(term, left, operands(term.values));
  });
}

AnyCondition::AnyCondition(std::span<const Condition> conditions, std::span<const Axis> axes) {
  for (const Axis& axis : axes) by_value_.emplace_back(axis.values.size());
  for (const Condition& condition : conditions) {
    const Condition::Term* term = rarest(condition);
    if (term == nullptr) {
      others_.push_back(&condition);
      continue;
    }
    for (std::size_t value = 0; value < term->outcomes.size(); ++value) {
      if (*term->outcomes[value]) by_value_[term->left.axis][value].push_back(&condition);
    }
  }
}

bool AnyCondition::holds(std::span<const std::uint32_t> choice) const {
  const auto here = [&](const Condition* condition) { return sweep::holds(*condition, choice); };
  for (std::size_t axis = 0; axis < by_value_.size(); ++axis) {
    if (std::ranges::any_of(by_value_[axis][choice[axis]], here)) return true;
  }
  return std::ranges::any_of(others_, here);
}

}  // namespace tools::sweep
