#pragma once
#include <span>

#include "traces/scene/animation.h"

namespace traces {

/// Computes the track's value at a time, `out.size()` numbers. Rotations (four numbers) have unit length; linear ones
/// follow the shortest arc. Arithmetic and square roots only, so that every host gets the same bits.
void sample(const Track& track, double seconds, std::span<double> out);

/// Computes in `out` the time derivative, per second, of a cubic spline track.
void sample_slope(const Track& track, double seconds, std::span<double> out);

}  // namespace traces
