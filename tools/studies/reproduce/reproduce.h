#pragma once
#include "tools/studies/reproduce/runner.h"

namespace tools::reproduce {

/// Runs a paper's experiments, one after the other, and leaves measured beside published in the output folder:
/// reproduce.md, reproduce.json and pictures, put there as each setting finishes and marked partial until all have;
/// then prints the table. Whatever ends it before, the same call goes on from what is finished. A scene that is not
/// there or cannot be used costs its rows alone. InputError for a paper that is not known and a configuration that is
/// none, before anything is run.
void reproduce(const Options& options);

}  // namespace tools::reproduce
