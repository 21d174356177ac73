#include "tools/studies/sweep/results/condition.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/studies/sweep/results/figure_noise.h"

namespace tools::results {
namespace {

using Op = Condition::Op;

constexpr std::array<std::pair<std::string_view, Op>, 7> kOps{{{"<=", Op::kAtMost},
                                                               {">=", Op::kAtLeast},
                                                               {"!=", Op::kNot},
                                                               {"==", Op::kEqual},
                                                               {"<", Op::kLess},
                                                               {">", Op::kMore},
                                                               {"=", Op::kEqual}}};

/// Reads a condition from left to right.
class ConditionReader {
 public:
  explicit ConditionReader(std::string_view text) : text_(text) { skip_blanks(); }

  bool at_end() const { return at_ == text_.size(); }

  std::string path() {
    const std::size_t begin = at_;
    while (!at_end() && is_of_path(text_[at_])) ++at_;
    if (at_ == begin) fail("a report path or an axis is missing");
    return taken(begin);
  }

  Op op() {
    for (const auto& [name, op] : kOps) {
      if (!text_.substr(at_).starts_with(name)) continue;
      at_ += name.size();
      skip_blanks();
      return op;
    }
    fail("one of <, <=, =, !=, >=, > is missing");
  }

  /// 'text', "text" or a word; a number may have its unit behind a blank.
  std::string value() {
    if (!at_end() && (text_[at_] == '\'' || text_[at_] == '"')) return quoted();
    const std::size_t begin = at_;
    while (!at_end() && is_of_word(text_[at_])) ++at_;
    if (at_ == begin) fail("a number or a text is missing");
    const std::size_t end = at_;
    std::string word = taken(begin);
    const std::size_t unit = at_;
    while (!at_end() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    const std::string with_unit = fmt::format("{} {}", word, text_.substr(unit, at_ - unit));
    if (at_ > unit && unit > end && sweep::magnitude_of(with_unit)) {
      skip_blanks();
      return with_unit;
    }
    at_ = unit;
    return word;
  }

  /// `value`: the one before.
  void conjunction(const std::string& value) {
    const std::size_t begin = at_;
    while (!at_end() && is_of_word(text_[at_])) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (word == "and") return skip_blanks();
    at_ = begin;
    if (word == "or") fail("'or' is not known: each --where, and each part joined by and, must hold");
    if (!word.empty() && sweep::magnitude_of(value)) {
      fail(
          fmt::format("'{}' behind '{}' is no unit of frequency, time or bytes; other figures are compared without "
                      "one, in the unit that their name ends with",
                      word, value));
    }
    fail("'and' is missing");
  }

 private:
  static bool is_of_path(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-' || c == '[' || c == ']';
  }
  static bool is_of_word(char c) { return is_of_path(c) || c == '+' || c == ':' || c == '/' || c == '%'; }

  void skip_blanks() {
    while (!at_end() && text_[at_] == ' ') ++at_;
  }
  std::string taken(std::size_t begin) {
    std::string word(text_.substr(begin, at_ - begin));
    skip_blanks();
    return word;
  }
  std::string quoted() {
    const std::size_t begin = at_ + 1, end = text_.find(text_[at_], begin);
    if (end == std::string_view::npos) fail("the quote that ends this text is missing");
    at_ = end + 1;
    skip_blanks();
    return std::string(text_.substr(begin, end - begin));
  }
  [[noreturn]] void fail(std::string_view what) const {
    throw sim::InputError(fmt::format("--where '{}': column {}: {}; allowed: PATH<NUMBER, PATH='TEXT', joined by and",
                                      sim::printable(text_), at_ + 1, what));
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

bool holds(Op op, int order) {
  switch (op) {
    case Op::kLess:
      return order < 0;
    case Op::kAtMost:
      return order <= 0;
    case Op::kEqual:
      return order == 0;
    case Op::kNot:
      return order != 0;
    case Op::kAtLeast:
      return order >= 0;
    case Op::kMore:
      return order > 0;
  }
  return false;
}

/// "mm2" of "12mm2"; empty for what does not begin with a number.
std::string unknown_unit(std::string_view text) {
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  return bad == std::errc{} ? sim::printable(text.substr(static_cast<std::size_t>(end - text.data()))) : "";
}

template <class T>
int order_of(const T& a, const T& b) {
  return a < b ? -1 : b < a ? 1 : 0;
}

}  // namespace

Condition::Condition(const std::string& text) : text_(text) {
  ConditionReader reader(text_);
  do {
    if (!comparisons_.empty()) reader.conjunction(comparisons_.back().wanted);
    Comparison one;
    one.path = reader.path();
    one.op = reader.op();
    one.wanted = reader.value();
    comparisons_.push_back(std::move(one));
  } while (!reader.at_end());
}

std::vector<bool> Condition::met_by(const Results& results) const {
  std::vector<bool> all(results.rows().size(), true);
  for (const Comparison& one : comparisons_) {
    const std::vector<bool> met = met_by(results, one);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = all[i] && met[i];
  }
  return all;
}

std::vector<bool> Condition::met_by(const Results& results, const Comparison& one) const {
  const Column column = column_of_means(results, one.path);
  const std::optional<sweep::Magnitude> wanted = sweep::magnitude_of(one.wanted);
  const bool is_order = one.op != Op::kEqual && one.op != Op::kNot;
  if (const std::string unit = unknown_unit(one.wanted); is_order && !wanted && !unit.empty()) {
    refuse(
        fmt::format("'{}' of '{}' is no unit of frequency, time or bytes; other figures are compared without one, in "
                    "the unit that their name ends with",
                    unit, sim::printable(one.wanted)));
  }
  if (is_order && !wanted) refuse(fmt::format("'{}' is no number", sim::printable(one.wanted)));
  std::vector<bool> met(column.values.size(), false);
  bool has_number = false;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const Value& value = column.values[i];
    if (is_absent(value)) continue;
    const std::optional<sweep::Magnitude> number = amount_of(value);
    has_number = has_number || number;
    if (number && wanted) {
      if (number->kind != wanted->kind) {
        refuse(fmt::format("{} has values such as '{}', with which '{}' cannot be compared", column.name,
                           sim::printable(exact_text(value)), sim::printable(one.wanted)));
      }
      met[i] = holds(one.op, order_of(number->value, wanted->value));
    } else if (!is_order) {
      met[i] = holds(one.op, order_of(exact_text(value), one.wanted));
    }
  }
  if (is_order && !has_number && std::ranges::any_of(column.values, std::not_fn(is_absent))) {
    refuse(fmt::format("{} is no number; texts are compared with = and != only", column.name));
  }
  return met;
}

std::vector<std::string> Condition::paths() const {
  std::vector<std::string> out;
  for (const Comparison& one : comparisons_) out.push_back(one.path);
  return out;
}

void Condition::refuse(const std::string& why) const {
  throw sim::InputError(fmt::format("--where '{}': {}", sim::printable(text_), why));
}

std::vector<std::string> compared_paths(const std::vector<std::string>& conditions) {
  std::vector<std::string> out;
  for (const std::string& text : conditions) {
    for (std::string& path : Condition(text).paths()) {
      if (std::ranges::find(out, path) == out.end()) out.push_back(std::move(path));
    }
  }
  return out;
}

std::vector<bool> meeting(const Results& results, const std::vector<std::string>& conditions) {
  std::vector<bool> all(results.rows().size(), true);
  for (const std::string& text : conditions) {
    const std::vector<bool> met = Condition(text).met_by(results);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = all[i] && met[i];
  }
  return all;
}

}  // namespace tools::results
