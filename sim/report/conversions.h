#pragma once

namespace sim {

/// Conversions from the units of counters to those of reports.
inline constexpr double kFemtosecondsPerNs = 1e6;
inline constexpr double kFemtosecondsPerMicrosecond = 1e9;
inline constexpr double kFemtosecondsPerMillisecond = 1e12;
inline constexpr double kPicojoulesPerMillijoule = 1e9;
inline constexpr double kWattsPerPicojouleOverFemtosecond = 1e3;

}  // namespace sim
