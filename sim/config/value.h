#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "sim/config/config_tree.h"

namespace sim {

/// Exception: a text is not a value of a configuration field. The exception contains the problem and the allowed
/// values; the caller adds file and line.
struct BadValue {
  std::string problem;
};

/// Parses a text and stores the value in a configuration field; for a Band, in all three numbers. Throws BadValue for a
/// text of the wrong kind. Does not check limits; value_problem() does.
void parse_value(const ConfigNode& field, std::string_view text);

/// Parses a number for a configuration field, with or without the field's unit. Throws BadValue.
double parse_number(const ConfigNode& field, std::string_view text);

/// Returns the problem with the value of a configuration field (outside limits, wrong order in a Band), or an empty
/// text.
std::string value_problem(const ConfigNode& field);

/// Returns the value of a configuration field as in a file, on one line. parse_value() and the YAML reader restore it.
std::string value_text(const ConfigNode& field);
std::string band_text(const Band& band);
/// Returns the boolean as which YAML 1.1 parsers read an unquoted word ("off", "on"), or nullopt for other words.
std::optional<bool> yaml_boolean_of(std::string_view word);
/// Returns `text` in double quotes, as a YAML scalar.
std::string double_quoted(std::string_view text);
/// Returns `key` as a YAML key, quoted where necessary.
std::string key_text(std::string_view key);

/// Returns the declared limits of a field combined with the range of its C++ type.
Limits effective_limits(const ConfigNode& field);

/// Returns the allowed values of a configuration field as text: "1 to 64 rays", "true, false", "powers of two from 16 B
/// to 256 B".
std::string allowed_text(const ConfigNode& field);

}  // namespace sim
