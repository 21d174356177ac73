#include "tools/studies/sweep/spec/condition.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/config/value.h"
#include "sim/error.h"
#include "sim/io/printable.h"

namespace tools::sweep {
namespace {

using Sign = std::pair<std::string_view, Comparison>;

constexpr std::array<Sign, 7> kSigns = {{{"<=", Comparison::kLessEqual},
                                         {">=", Comparison::kGreaterEqual},
                                         {"!=", Comparison::kUnequal},
                                         {"==", Comparison::kEqual},
                                         {"<", Comparison::kLess},
                                         {">", Comparison::kGreater},
                                         {"=", Comparison::kEqual}}};

/// Returns the comparison sign that the text begins with; null if it begins with none.
const Sign* find_sign(std::string_view text) {
  const auto sign = std::ranges::find_if(kSigns, [&](const Sign& s) { return text.starts_with(s.first); });
  return sign == kSigns.end() ? nullptr : &*sign;
}

/// Parses the text of a condition from left to right.
class ConditionReader {
 public:
  explicit ConditionReader(std::string_view text) : text_(text) { skip_blanks(); }

  bool at_end() const { return at_ == text_.size(); }

  /// Reads a report path, an axis, or a function of a path: worst(fps).
  std::string read_name() {
    const std::size_t begin = at_;
    while (!at_end() && is_of_path(text_[at_])) ++at_;
    if (at_ == begin) fail("a report path or an axis is missing");
    if (!at_end() && text_[at_] == '(') {
      const std::size_t end = text_.find(')', at_);
      if (end == std::string_view::npos) fail("the ) that ends this function is missing");
      at_ = end + 1;
    }
    return word_from(begin);
  }

  Comparison read_comparison() {
    if (const auto* sign = find_sign(text_.substr(at_))) {
      at_ += sign->first.size();
      skip_blanks();
      return sign->second;
    }
    fail("one of <, <=, =, !=, >=, > is missing");
  }

  /// Reads 'text', "text" or a word; a number may be followed by a blank and its unit.
  std::string read_value() {
    if (!at_end() && (text_[at_] == '\'' || text_[at_] == '"')) return read_quoted();
    const std::size_t begin = at_;
    while (!at_end() && is_of_word(text_[at_])) ++at_;
    if (at_ == begin) fail("a number or a text is missing");
    const std::size_t end = at_;
    std::string word = word_from(begin);
    const std::size_t unit = at_;
    while (!at_end() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    const std::string with_unit = fmt::format("{} {}", word, text_.substr(unit, at_ - unit));
    if (at_ > unit && unit > end && parse_magnitude(with_unit)) {
      skip_blanks();
      return with_unit;
    }
    at_ = unit;
    return word;
  }

  /// Reads the word `and` between two comparisons of a condition. `value`: the value before it, for error messages.
  void read_and(const std::string& value) {
    const std::size_t begin = at_;
    while (!at_end() && is_of_word(text_[at_])) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (word == "and") return skip_blanks();
    at_ = begin;
    if (word == "or") fail("'or' is not known: each --where, and each part joined by and, must hold");
    if (!word.empty() && parse_magnitude(value)) {
      fail(
          fmt::format("'{}' after '{}' is no unit of frequency, time or bytes; other figures are compared without "
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
  std::string word_from(std::size_t begin) {
    std::string word(text_.substr(begin, at_ - begin));
    skip_blanks();
    return word;
  }
  std::string read_quoted() {
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

}  // namespace

std::optional<bool> compare(const Operand& left, Comparison comparison, const Operand& right) {
  const std::optional<Magnitude>&a = left.magnitude, &b = right.magnitude;
  const bool are_numbers = a && b;
  if (are_numbers ? a->kind != b->kind : needs_order(comparison)) return std::nullopt;
  switch (comparison) {
    case Comparison::kEqual:
      return are_numbers ? a->value == b->value : left.text == right.text;
    case Comparison::kUnequal:
      return are_numbers ? a->value != b->value : left.text != right.text;
    case Comparison::kLess:
      return a->value < b->value;
    case Comparison::kLessEqual:
      return a->value <= b->value;
    case Comparison::kGreater:
      return a->value > b->value;
    default:
      return a->value >= b->value;
  }
}

std::pair<Comparison, std::string> parse_comparison(const std::string& text) {
  const Sign* sign = find_sign(text);
  if (sign == nullptr) return {Comparison::kEqual, text};
  const std::size_t begin = text.find_first_not_of(" =", sign->first.size());
  return {sign->second, begin == std::string::npos ? "" : text.substr(begin)};
}

std::vector<ConditionTerm> parse_condition(const std::string& text) {
  ConditionReader reader(text);
  std::vector<ConditionTerm> terms;
  do {
    if (!terms.empty()) reader.read_and(terms.back().value);
    ConditionTerm& term = terms.emplace_back();
    term.name = reader.read_name();
    term.comparison = reader.read_comparison();
    term.value = reader.read_value();
  } while (!reader.at_end());
  return terms;
}

std::optional<Magnitude> parse_magnitude(std::string_view text) {
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (bad == std::errc{} && end == text.data() + text.size()) return Magnitude{Magnitude::Kind::kNumber, number};
  if (text.find_first_of("0123456789.") != 0) return std::nullopt;
  for (const auto& [kind, units] : {std::pair{Magnitude::Kind::kFrequency, sim::frequency_units()},
                                    {Magnitude::Kind::kBytes, sim::byte_units()},
                                    {Magnitude::Kind::kTime, sim::duration_units()}}) {
    try {
      return Magnitude{kind, static_cast<double>(sim::read_quantity(text, units))};
    } catch (const sim::BadValue&) {
    }
  }
  return std::nullopt;
}

std::string exact_text(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
  return {};
}

std::optional<Magnitude> magnitude_of(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    const std::optional<Magnitude> amount = parse_magnitude(*text);
    return amount && std::isfinite(amount->value) ? amount : std::nullopt;
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    return Magnitude{Magnitude::Kind::kNumber, static_cast<double>(*whole)};
  }
  if (const auto* real = std::get_if<double>(&value)) return Magnitude{Magnitude::Kind::kNumber, *real};
  return std::nullopt;
}

bool sorts_before(const Value& a, const Value& b) {
  const auto key = [](const Value& value) {
    const std::optional<Magnitude> number = magnitude_of(value);
    const int group = number ? 0 : is_absent(value) ? 2 : 1;
    return std::tuple(group, number ? number->value : 0, number ? std::string() : exact_text(value));
  };
  return key(a) < key(b);
}

}  // namespace tools::sweep
