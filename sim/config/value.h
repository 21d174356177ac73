#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "sim/config/config_tree.h"

namespace sim {

/// Why a text cannot become a field's value, and what is allowed instead. The caller knows where the text stands.
struct BadValue {
  std::string problem;
};

/// Reads a field's value, or the one figure of a Spread, from `text`. Throws BadValue for what is not of the field's
/// kind; limits are value_problem's.
void assign(const ConfigNode& field, std::string_view text);

/// A number with the field's unit or none. Throws BadValue.
double number_of(const ConfigNode& field, std::string_view text);

/// The fault of the value a field holds now (limits, the order of a Spread); empty if nothing.
std::string value_problem(const ConfigNode& field);

/// The value as in a configuration file, on one line; `assign` and the YAML reader turn it back into the same value.
std::string value_text(const ConfigNode& field);
std::string spread_text(const Spread& spread);
/// The boolean that YAML 1.1 readers make of an unquoted word ("off", "on"); none for all other words.
std::optional<bool> boolean_of_word(std::string_view word);
/// `text` as a YAML scalar in double quotes.
std::string double_quoted(std::string_view text);
/// `key` as a YAML key, in quotes unless it is safe without.
std::string key_text(std::string_view key);

/// The bounds that hold: the declared ones, and those of the member's type.
Limits effective_limits(const ConfigNode& field);

/// "1 to 64 rays", "true, false", "powers of two from 16 B to 256 B": what a field may hold.
std::string allowed_text(const ConfigNode& field);

}  // namespace sim
