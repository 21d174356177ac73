#pragma once
#include <cstdint>

#include "tools/run/frame/run_job.h"

namespace tools::reproduce {

/// Share of the view's pixels whose surface sends a reflection ray, by a small picture of it.
double reflective_share(Inputs& inputs, std::uint32_t threads);

/// Makes materials mirrors, and mirrors dull, until about `share` (0 to 1) of the view's pixels reflect; glass stays as
/// it is. Materials are taken in the order of the pixels they cover, each that still fits.
void set_reflective_share(Inputs& inputs, double share, std::uint32_t threads);

}  // namespace tools::reproduce
