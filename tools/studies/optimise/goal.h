#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace tools::optimise {

/// A demand on a figure of a point.
struct Goal {
  enum class Kind : std::uint8_t { kMax, kMin, kBelow, kAtMost, kAbove, kAtLeast };
  Kind kind = Kind::kMax;
  std::string figure;  ///< a report path, or a clear end of one
  double limit = 0;    ///< for a constraint only
  std::string at;      ///< "file:line:column", for messages

  bool is_objective() const { return kind == Kind::kMax || kind == Kind::kMin; }
  bool is_upper() const { return kind == Kind::kBelow || kind == Kind::kAtMost; }
  /// Is the constraint met?
  bool is_met(double value) const;
  std::string text() const;
  /// Title of a column of rooms: "room to < 1.4".
  std::string room_title() const;
  /// Distance of a value from a constraint's limit, below 0 if it breaks it: a share of the limit, or if that is 0 the
  /// difference itself.
  double room(double value) const;
  /// The same for people: "1.7 %", "-0.25".
  std::string room_text(double value) const;
};
constexpr std::array<std::string_view, 6> names_of(Goal::Kind) { return {"max", "min", "<", "<=", ">", ">="}; }

/// "power_w.nominal < 1". InputError for anything but PATH, one of < <= > >=, NUMBER.
Goal read_constraint(const std::string& text);

}  // namespace tools::optimise
