#pragma once
#include <span>

#include "traces/scene/animation.h"

namespace traces {

/// The track's value at that time, `out.size()` numbers; rotations (four) at unit length, linear ones on the shortest
/// arc. Made of arithmetic and square roots only, so that every host gets the same bits.
void sample(const Track& track, double seconds, std::span<double> out);

/// Returns in `out` the time derivative, per second, of a cubic spline track at a time.
void sample_slope(const Track& track, double seconds, std::span<double> out);

}  // namespace traces
