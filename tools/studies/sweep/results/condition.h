#pragma once
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// "power_w.nominal<1 and tni.trv.l1.size>='16 KiB'"
class Condition {
 public:
  enum class Op { kLess, kAtMost, kEqual, kNot, kAtLeast, kMore };

  /// InputError with the column for what is no list of comparisons joined by `and`.
  explicit Condition(const std::string& text);

  /// Which points meet it, by the means of replicates; a point without the value does not. InputError for paths that
  /// mean nothing or several things, and for numbers compared with text or without the unit that the values have.
  std::vector<bool> met_by(const Results& results) const;

  std::vector<std::string> paths() const;

 private:
  struct Comparison {
    std::string path;
    Op op = Op::kEqual;
    std::string wanted;
  };
  std::vector<bool> met_by(const Results& results, const Comparison& one) const;
  [[noreturn]] void refuse(const std::string& why) const;

  std::string text_;
  std::vector<Comparison> comparisons_;
};

/// Paths that conditions compare, each once, as they write them.
std::vector<std::string> compared_paths(const std::vector<std::string>& conditions);

/// Points that meet all conditions.
std::vector<bool> meeting(const Results& results, const std::vector<std::string>& conditions);

}  // namespace tools::results
