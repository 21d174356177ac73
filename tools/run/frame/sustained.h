#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/report/energy.h"
#include "sim/report/thermal.h"
#include "sim/time.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// A frame at one of the governor's clocks.
struct SustainFrame {
  double seconds = 0;
  double dynamic_j = 0;  ///< chip without leakage
  double leakage_w = 0;  ///< chip, at the configured temperature
  double memory_j = 0;
};

/// Converts a played frame's time and energy.
SustainFrame sustain_frame(const sim::EnergyReport& energy, sim::Time elapsed);

/// A clock that the governor may choose.
struct SustainStep {
  double factor = 1;                 ///< over the configured clocks
  std::vector<SustainFrame> frames;  ///< of the sequence, which repeats
};

/// Device, governor and duration of a sustained run.
struct SustainSetup {
  sim::ThermalConfig thermal;
  double leakage_temperature = 75, leakage_doubling = 25;  ///< of SustainFrame::leakage_w; K that double it
  double idle_leakage = 0, idle_memory_w = 0;              ///< between frames
  double seconds = 600, loop = 60, fps = 0;
};

/// Returns the setup of a configuration: `seconds` is thermal.minutes, `loop` a minute.
SustainSetup sustain_setup(const RunConfig& config);

/// Means over a loop, temperatures at its end.
struct SustainLoop {
  double fps = 0, watt = 0, factor = 0;
  double least_factor = 0;
  sim::Temperatures temperatures{};
};

/// Result of a repeated frame or sequence in a device with a governor.
struct Sustained {
  std::vector<SustainLoop> loops;
  std::uint64_t frames = 0;
  double seconds = 0;
  double energy_j = 0;        ///< of the GPU and its memory
  sim::Temperatures hottest;  ///< each node's own highest
  std::size_t changes = 0;    ///< of the clock
  double first_fps = 0;       ///< of the first loop
  double sustained_fps = 0;   ///< of the last loop
  double stability() const;   ///< worst over best loop
};

/// Returns the factors of the governor's clocks, the fastest first.
std::vector<double> governor_factors(const sim::ThermalConfig& config);
/// Returns the configurations of these clocks, each at the voltage that it needs.
std::vector<RunConfig> governor_configs(const RunConfig& config);

/// Runs the sequence for the time of `setup`, from a device at ambient temperature. `steps`: the fastest first. Throws
/// InputError above 1e9 frames.
Sustained sustain(const std::vector<SustainStep>& steps, const SustainSetup& setup);

/// Returns the steady temperatures of a step without the governor; none if leakage runs away.
std::optional<sim::Temperatures> steady_temperatures(const SustainStep& step, const SustainSetup& setup);

/// Returns a warning if the slowest clocks end above a temperature limit, which the governor then cannot hold.
std::vector<std::string> limit_warnings(const std::vector<SustainStep>& steps, const SustainSetup& setup);

}  // namespace tools
