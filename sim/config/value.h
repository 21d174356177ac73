#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "sim/config/config_tree.h"

namespace sim {

/// Exception for a text that is not a value of a configuration field: the problem and what is allowed. The caller adds
/// the place.
struct BadValue {
  std::string problem;
};

/// Parses a text and stores the value in a configuration field, or in all three numbers of a Band. Throws BadValue for
/// a text of the wrong kind. Does not check limits; value_problem() does.
void parse_value(const ConfigNode& field, std::string_view text);

/// Parses a number, with or without the field's unit. Throws BadValue.
double parse_number(const ConfigNode& field, std::string_view text);

/// Returns what is wrong with the value of a configuration field (limits, order of a Band), or an empty text.
std::string value_problem(const ConfigNode& field);

/// Returns the value of a configuration field as in a file, on one line. parse_value() and the YAML reader restore it.
std::string value_text(const ConfigNode& field);
std::string band_text(const Band& band);
/// Returns the boolean that YAML 1.1 readers make of an unquoted word ("off", "on"), or nullopt for other words.
std::optional<bool> boolean_of_word(std::string_view word);
/// Returns `text` as a YAML scalar in double quotes.
std::string double_quoted(std::string_view text);
/// Returns `key` as a YAML key, quoted where necessary.
std::string key_text(std::string_view key);

/// Returns the declared limits of a field combined with the range of its C++ type.
Limits effective_limits(const ConfigNode& field);

/// Returns which values a configuration field may have, as text: "1 to 64 rays", "true, false", "powers of two from 16
/// B to 256 B".
std::string allowed_text(const ConfigNode& field);

}  // namespace sim
