#pragma once
#include <cstdint>

#include "tools/studies/baseline/suite.h"

namespace tools {

/// Refuses what a suite keeps if it is a misspelling, before its runs: a picture of 16x16 by each of their programs
/// says what paths reports have. What such a picture lacks and is near to nothing that it has may be another scene's,
/// and is told after the runs. InputError with the suite's line and the nearest path.
void refuse_misspelt(const Suite& suite, std::uint32_t jobs);

}  // namespace tools
