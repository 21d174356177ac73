#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "tools/studies/sweep/spec/magnitude.h"

namespace tools::results {

/// A cell of the results: nothing, a number, or text. Whole numbers stay whole.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

inline bool is_absent(const Value& value) { return std::holds_alternative<std::monostate>(value); }

/// The shortest decimals that read back exactly, the text, or "".
std::string exact_text(const Value& value);

/// The value of a number, or of a text that is one; nothing for all else.
std::optional<sweep::Magnitude> amount_of(const Value& value);

/// Order of a column: numbers by their amount, then texts, then what is absent.
bool is_before(const Value& a, const Value& b);

}  // namespace tools::results
