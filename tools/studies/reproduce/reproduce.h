#pragma once
#include "tools/studies/reproduce/runner.h"

namespace tools::reproduce {

/// Runs the experiments of a paper and compares measured with published values.
///   1. After each setting the output folder has reproduce.md, reproduce.json and pictures, marked partial until all
///   are
///      done. At the end the table is printed.
///   2. If it is stopped, the same call continues with the missing settings.
///   3. A missing or broken scene loses only its own rows.
/// InputError for an unknown paper or an invalid configuration, before anything runs.
void reproduce(const Options& options);

}  // namespace tools::reproduce
