#pragma once
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"
#include "tools/studies/sweep/spec/yaml_value.h"

namespace tools::sweep {

/// [{AXIS: VALUE, AXIS: [VALUES], AXIS: "< VALUE", AXIS: ">= AXIS"}, ...]. InputError.
std::vector<Condition> read_conditions(const YamlValue& value, std::span<const Axis> axes);

/// Whether a combination meets the condition; `choice` has the index of a value for each axis.
bool holds(const Condition& condition, std::span<const std::uint32_t> choice);

/// Whether any of many conditions is met. Only those are looked at of which a term, the rarest, holds for one of the
/// combination's values. Refers to the conditions.
class AnyCondition {
 public:
  AnyCondition(std::span<const Condition> conditions, std::span<const Axis> axes);
  bool holds(std::span<const std::uint32_t> choice) const;

 private:
  std::vector<std::vector<std::vector<const Condition*>>> by_value_;  ///< by axis and value
  std::vector<const Condition*> others_;                              ///< have no such term
};

}  // namespace tools::sweep
