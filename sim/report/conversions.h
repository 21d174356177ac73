#pragma once

namespace sim {

/// Between what counters hold and what people read.
inline constexpr double kFemtosecondsPerNs = 1e6;
inline constexpr double kFemtosecondsPerMicrosecond = 1e9;
inline constexpr double kFemtosecondsPerMillisecond = 1e12;
inline constexpr double kPicojoulesPerMillijoule = 1e9;
inline constexpr double kWattsPerPicojouleOverFemtosecond = 1e3;

}  // namespace sim
