#pragma once
#include <span>

#include "tools/studies/sweep/spec/spec.h"
#include "tools/studies/sweep/spec/yaml_value.h"

namespace tools::sweep {

/// KEY: [values], or KEY: {from, to, step | count | factor, scale}, or NAME: {keys: [...], values: ...}. InputError.
Axis read_axis(const YamlValue& value);
/// An axis of one key from a list.
Axis read_list(const std::string& key, const YamlValue& value);
/// The axis `workload`: scenes, with camera, frames and resolution where wanted.
Axis read_workloads(const YamlValue& value);
/// InputError if two axes move one key, or there are too many.
void check_axes(std::span<const Axis> axes);

}  // namespace tools::sweep
