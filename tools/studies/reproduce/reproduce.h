#pragma once
#include "tools/studies/reproduce/runner.h"

namespace tools::reproduce {

/// Runs a paper's experiments, one after the other, and leaves measured beside published in the output folder:
/// reproduce.md, reproduce.json and pictures, brought up to date as each setting finishes; then prints the table. An
/// interrupt or an error keeps what is finished, marked partial. A scene that is not there or cannot be used costs its
/// rows alone. InputError for a paper that is not known and a configuration that is none, before anything is run.
void reproduce(const Options& options);

}  // namespace tools::reproduce
