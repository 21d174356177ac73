#pragma once
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"
#include "tools/studies/sweep/spec/yaml_value.h"

namespace tools::sweep {

/// [{AXIS: VALUE, AXIS: [VALUES], AXIS: "< VALUE", AXIS: ">= AXIS"}, ...]. InputError.
std::vector<Condition> read_conditions(const YamlValue& value, std::span<const Axis> axes);

/// Whether a combination meets the condition; `choice` has the index of a value for each axis.
bool holds(const Condition& condition, std::span<const Axis> axes, std::span<const std::uint32_t> choice);

}  // namespace tools::sweep
