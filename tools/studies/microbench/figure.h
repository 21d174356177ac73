#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tools {

/// Something measured on a piece of the machine, beside its closed form.
struct Figure {
  /// How the two must compare.
  enum class Holds : std::uint8_t {
    kExactly,
    kClosely,  ///< within 2 %
    kNearly,   ///< between nine tenths of the form and all of it
    kAtMost,   ///< the form is an upper bound (2 % for the ends of a measurement)
    kAtLeast,  ///< the form is a lower bound
  };
  std::string name;
  std::string unit;
  double measured = 0;
  double expected = 0;
  Holds holds = Holds::kExactly;
  std::string remark{};  ///< such as what sets the bound

  bool good() const;
  /// 0 if both are 0.
  double relative_error() const;
};

/// Results of a benchmark.
struct Findings {
  std::string title;
  std::vector<Figure> figures;
  std::vector<std::string> notes{};  ///< lines below the table
  std::string table{};               ///< a shorter table in place of the one of all figures
  std::string printed{};             ///< text in place of all others, as asked for

  bool good() const;
};

/// One of several upper bounds, with the name of what sets it.
struct UpperBound {
  double value = 0;
  std::string_view by;
  bool reached = true;  ///< else waiting, which the form leaves out, keeps a unit below it

  /// How a measurement compares with it.
  Figure::Holds holds() const { return reached ? Figure::Holds::kClosely : Figure::Holds::kAtMost; }
};
/// The tightest; one that is not reached itself and lies less than half as much above keeps it from being reached.
UpperBound least(const std::vector<UpperBound>& bounds);

std::string table_of(const Findings& findings);
/// Schema raywatt-microbench/1.
std::string json_of(std::string_view benchmark, const Findings& findings);

}  // namespace tools
