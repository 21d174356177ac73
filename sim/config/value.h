#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "sim/config/config_tree.h"

namespace sim {

/// Thrown for a text that is not a value of the field: the problem and what is allowed. The caller adds the place.
struct BadValue {
  std::string problem;
};

/// Parses `text` into a field, or into all of a Band. Throws BadValue for a wrong kind; value_problem() checks
/// limits.
void parse_value(const ConfigNode& field, std::string_view text);

/// Parses a number with the field's unit or without a unit. Throws BadValue.
double parse_number(const ConfigNode& field, std::string_view text);

/// Returns what is wrong with the value of a field (limits, order of a Band); empty if nothing.
std::string value_problem(const ConfigNode& field);

/// Returns the value as in a configuration file, on one line. parse_value() and the YAML reader restore it.
std::string value_text(const ConfigNode& field);
std::string band_text(const Band& band);
/// Returns the boolean that YAML 1.1 readers make of an unquoted word ("off", "on"), if any.
std::optional<bool> boolean_of_word(std::string_view word);
/// Returns `text` as a YAML scalar in double quotes.
std::string double_quoted(std::string_view text);
/// Returns `key` as a YAML key, quoted where necessary.
std::string key_text(std::string_view key);

/// Returns the declared limits combined with the range of the member's type.
Limits effective_limits(const ConfigNode& field);

/// Returns what a field may hold: "1 to 64 rays", "true, false", "powers of two from 16 B to 256 B".
std::string allowed_text(const ConfigNode& field);

}  // namespace sim
