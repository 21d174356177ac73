#include "tools/run/frame/sustained.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/report/table.h"
#include "tools/run/frame/frame_rate.h"
#include "tools/run/frame/power.h"

namespace tools {
namespace {

constexpr double kPicojoulesPerJoule = 1e12;
/// Maximum number of frames of a sustained run, so that it ends within minutes.
constexpr double kMostSustainedFrames = 1e9;
/// Relative tolerance for rounding in sums of frame times.
constexpr double kTimeRounding = 1e-9;

/// True if a sum of frame times reaches `end`, within rounding.
bool has_reached(double seconds, double end) { return seconds >= end * (1 - kTimeRounding); }

/// Returns the seconds from the begin of a frame to the begin of the next one.
double frame_period(const SustainFrame& frame, const SustainSetup& setup) {
  return setup.fps > 0 ? std::max(frame.seconds, 1 / setup.fps) : frame.seconds;
}

/// Computes means over the current loop of a sustained run.
class LoopMean {
 public:
  void add(double seconds, double joules, double factor, bool is_frame) {
    seconds_ += seconds;
    joules_ += joules;
    weighted_factor_ += factor * seconds;
    least_factor_ = std::min(least_factor_, factor);
    if (is_frame) frames_ += 1;
  }
  /// Records a frame that takes longer than the period of its target rate.
  void add_late_frame() { has_late_frame_ = true; }
  /// Returns the means. `fps`: target rate, which a loop without late frames has exactly; 0: none.
  SustainLoop close(const sim::Temperatures& temperatures, double fps) {
    const bool is_at_target = fps > 0 && !has_late_frame_;  // the quotient may be below it by rounding
    const SustainLoop loop{is_at_target ? fps : frames_ / seconds_, joules_ / seconds_, weighted_factor_ / seconds_,
                           least_factor_, temperatures};
    *this = {};
    return loop;
  }

 private:
  double seconds_ = 0, joules_ = 0, weighted_factor_ = 0, least_factor_ = 1, frames_ = 0;
  bool has_late_frame_ = false;
};

/// Simulates a device in which a sequence of frames repeats at the governor's clocks.
class Device {
 public:
  Device(const std::vector<SustainStep>& steps, const SustainSetup& setup)
      : steps_(steps),
        setup_(setup),
        network_(setup.thermal),
        governor_(setup.thermal, steps.size()),
        now_{setup.thermal.ambient, setup.thermal.ambient} {
    result_.hottest = now_;
    for (const SustainStep& step : steps) {
      auto& of_step = decays_.emplace_back();
      for (const SustainFrame& frame : step.frames) of_step.push_back(network_.decay_over(frame.seconds));
    }
  }

  /// Runs frame `number` of the repeated sequence. Returns true when the duration of the run is over.
  bool run_frame(std::size_t number) {
    const std::size_t step = governor_.clock_step(), index = number % steps_[step].frames.size();
    const SustainFrame& frame = steps_[step].frames[index];
    const double leakage = frame.leakage_w * leakage_factor();
    spend(frame.seconds, {frame.dynamic_j / frame.seconds + leakage, frame.memory_j / frame.seconds},
          decays_[step][index], true);
    const double rest = frame_period(frame, setup_) - frame.seconds;
    if (setup_.fps * frame.seconds > 1) mean_.add_late_frame();
    if (rest > 0) {
      const double idle = frame.leakage_w * leakage_factor() * setup_.idle_leakage + frame.idle_clock_w;
      spend(rest, {idle, setup_.idle_memory_w}, network_.decay_over(rest), false);
    }
    if (const double since = result_.seconds - last_decision_; has_reached(since, setup_.thermal.period)) {
      result_.changes += governor_.choose_next_clock(now_, since) ? 1 : 0;
      last_decision_ = result_.seconds;
    }
    const double loop_end = setup_.loop * static_cast<double>(result_.loops.size() + 1);
    if (has_reached(result_.seconds, loop_end)) result_.loops.push_back(mean_.close(now_, setup_.fps));
    return has_reached(result_.seconds, setup_.seconds);
  }

  Sustained finish() && {
    if (result_.loops.empty()) result_.loops.push_back(mean_.close(now_, setup_.fps));
    result_.first_fps = result_.loops.front().fps;
    result_.sustained_fps = result_.loops.back().fps;
    return std::move(result_);
  }

 private:
  double leakage_factor() const { return std::exp2((now_.die - setup_.leakage_temperature) / setup_.leakage_doubling); }
  void spend(double seconds, const sim::HeatFlow& gpu, const sim::ThermalNetwork::Decay& decay, bool is_frame) {
    now_ = network_.temperatures_after(now_, {gpu.die, gpu.body + setup_.thermal.other_power}, decay);
    const double joules = (gpu.die + gpu.body) * seconds;
    result_.seconds += seconds;
    result_.energy_j += joules;
    result_.frames += is_frame ? 1 : 0;
    result_.hottest = {std::max(result_.hottest.die, now_.die), std::max(result_.hottest.body, now_.body)};
    mean_.add(seconds, joules, steps_[governor_.clock_step()].factor, is_frame);
  }

  const std::vector<SustainStep>& steps_;
  const SustainSetup& setup_;
  const sim::ThermalNetwork network_;
  /// Factors by which temperatures decay during a frame, by clock step and frame of the sequence.
  std::vector<std::vector<sim::ThermalNetwork::Decay>> decays_;
  ThermalGovernor governor_;
  sim::Temperatures now_;
  double last_decision_ = 0;  ///< time of the governor's last decision, in s
  LoopMean mean_;
  Sustained result_;
};

}  // namespace

double Sustained::stability() const {
  const auto [worst, best] = std::ranges::minmax(loops, {}, &SustainLoop::fps);
  return worst.fps / best.fps;
}

std::vector<double> governor_factors(const sim::ThermalConfig& config) {
  std::vector<double> factors = {1};
  for (std::uint32_t i = 1; i < config.steps; ++i) {
    factors.push_back(1 - (1 - config.slowest) * i / (config.steps - 1));
  }
  return factors;
}

std::vector<RunConfig> governor_configs(const RunConfig& config) {
  std::vector<std::string> domains;
  for (const ClockDomain& domain : clock_domains()) domains.emplace_back(domain.name);
  std::vector<RunConfig> configs;
  for (const double factor : governor_factors(config.thermal)) {
    configs.push_back(config_at_clocks(config, domains, factor, fmt::format("thermal: clocks x {:.3g}", factor)));
  }
  return configs;
}

SustainSetup sustain_setup(const RunConfig& config) {
  SustainSetup setup;
  setup.thermal = config.thermal;
  setup.leakage_temperature = config.power.temperature;
  setup.leakage_doubling = config.power.leakage_doubling;
  setup.idle_leakage = config.power.idle == sim::ChipIdle::kPowerGated ? config.power.idle_leakage : 1;
  setup.idle_memory_w = hw::dram_idle_power_mw(config.gpu->dram).nominal / kMilliwattsPerWatt;
  setup.seconds = 60 * config.thermal.minutes;
  setup.loop = std::min(setup.loop, setup.seconds);
  setup.fps = config.frame.fps;
  return setup;
}

SustainFrame sustain_frame(const RunConfig& config, const sim::EnergyReport& energy,
                           std::span<const sim::UnitReport> units, sim::Time elapsed) {
  SustainFrame frame;
  const double ms = static_cast<double>(elapsed) / sim::kFemtosecondsPerMillisecond;
  frame.seconds = ms / 1e3;
  frame.leakage_w = chip_leakage_mw(energy, ms) / kMilliwattsPerWatt;
  const auto memory = energy.blocks.find("dram");
  if (memory != energy.blocks.end()) frame.memory_j = memory->second.total().nominal / kPicojoulesPerJoule;
  frame.dynamic_j = energy.total_pj.nominal / kPicojoulesPerJoule - frame.memory_j - frame.leakage_w * frame.seconds;
  frame.idle_clock_w = idle_clock_mw(config, units) / kMilliwattsPerWatt;
  return frame;
}

Sustained sustain(const std::vector<SustainStep>& steps, const SustainSetup& setup) {
  const double shortest = frame_period(steps.front().frames.front(), setup);
  if (!(setup.seconds / shortest <= kMostSustainedFrames)) {
    throw sim::InputError(
        fmt::format("thermal.minutes: {:.4g} minutes of frames of {:.3g} s; allowed: at most {:.0e} frames",
                    setup.seconds / 60, shortest, kMostSustainedFrames));
  }
  Device device(steps, setup);
  for (std::size_t frame = 0; !device.run_frame(frame); ++frame) {
  }
  return std::move(device).finish();
}

std::optional<sim::Temperatures> steady_temperatures(const SustainStep& step, const SustainSetup& setup) {
  double seconds = 0, dynamic_j = 0, leakage_j = 0, memory_j = 0;
  for (const SustainFrame& frame : step.frames) {
    const double period = frame_period(frame, setup);
    const double rest = period - frame.seconds;
    seconds += period;
    dynamic_j += frame.dynamic_j + rest * frame.idle_clock_w;
    leakage_j += frame.leakage_w * (frame.seconds + rest * setup.idle_leakage);
    memory_j += frame.memory_j + rest * setup.idle_memory_w;
  }
  return sim::ThermalNetwork(setup.thermal)
      .steady_with_leakage({dynamic_j / seconds, memory_j / seconds + setup.thermal.other_power}, leakage_j / seconds,
                           setup.leakage_temperature, setup.leakage_doubling);
}

std::vector<std::string> limit_warnings(const std::vector<SustainStep>& steps, const SustainSetup& setup) {
  const std::optional<sim::Temperatures> end = steady_temperatures(steps.back(), setup);
  const sim::ThermalConfig& thermal = setup.thermal;
  if (end && end->die <= thermal.die_limit && end->body <= thermal.body_limit) return {};
  const std::string where =
      end ? fmt::format("end at {:.1f} C of the die and {:.1f} C of the body", end->die, end->body)
          : std::string("let leakage run away");
  return {
      fmt::format("thermal: the slowest clocks (x {:.3g}) {}; limits are {:.4g} C and {:.4g} C: the governor cannot "
                  "hold them, thermal.slowest sets the slowest clocks",
                  steps.back().factor, where, thermal.die_limit, thermal.body_limit)};
}

}  // namespace tools
