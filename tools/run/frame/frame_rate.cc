#include "tools/run/frame/frame_rate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/report/energy.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "sim/time.h"
#include "tools/run/frame/power.h"

namespace tools {
namespace {

constexpr double kPicojoulesPerMillisecond = 1e-6;  // converts pJ per ms to mW
constexpr sim::Time kMillisecond = sim::kFemtosecondsPerSecond / 1000;
constexpr double kHertzPerMegahertz = 1e6;
/// Relative rounding tolerance when a frame's time is compared with the period.
constexpr double kRateRounding = 1e-9;
/// Number of clock settings among which the one with the least power is searched.
constexpr int kOperatingPoints = 256;

/// Returns the energy of the chip, without the memory, in a millisecond in which every unit is idle.
sim::EnergyReport idle_energy(const RunConfig& config, std::span<const sim::UnitReport> units) {
  return sim::compute_energy(idle_millisecond_reports(units), config.energy, hw::dram_energy_events(config.gpu->dram),
                             kMillisecond, power_scales(config));
}

/// The chip's clocks multiplied by a factor, the voltages that they need, and the resulting energy scale of each block.
struct ScaledClocks {
  double factor = 1;
  std::vector<double> mhz{}, volt{};
  std::map<std::string, sim::PowerScale> blocks{};
  sim::PowerScale power_scale_of(const std::string& block) const {
    const auto found = blocks.find(block);
    return found == blocks.end() ? sim::PowerScale{} : found->second;
  }
};

/// Returns the power of the chip, without the memory, between frames, in mW.
sim::Band chip_idle_mw(const RunConfig& config, const sim::EnergyReport& idle, const ScaledClocks& clocks) {
  sim::Band sum;
  for (const ClockDomain& domain : clock_domains()) {
    for (const std::string& name : domain.blocks) {
      const auto block = idle.blocks.find(name);  // a machine may have no rasteriser or builder
      if (block == idle.blocks.end()) continue;
      const sim::PowerScale scale = clocks.power_scale_of(name);
      sum += remaining_between_frames(config.power, block->second.leakage * scale.leakage,
                                      block->second.clock * (scale.dynamic * clocks.factor));
    }
  }
  return sum * kPicojoulesPerMillisecond;
}

/// Returns the energy of all frames at other clocks, if the number of cycles stays the same.
sim::Band energy_at(const sim::EnergyReport& energy, const ScaledClocks& clocks) {
  sim::Band sum;
  for (const auto& [name, block] : energy.blocks) {
    const sim::PowerScale scale = clocks.power_scale_of(name);
    sum += (block.dynamic + block.clock) * scale.dynamic + block.leakage * (scale.leakage / clocks.factor);
    if (name != "dram") continue;
    const auto events = energy.events.find(name);
    // refreshes per second do not depend on the clocks
    for (const char* refresh : {"dram.refresh", "dram.refresh_all"}) {
      if (events == energy.events.end() || !events->second.contains(refresh)) continue;
      sum += events->second.at(refresh) * (1 / clocks.factor - 1);
    }
  }
  return sum;
}

/// Returns the mean power in W over a frame period, including its idle time. `pj`: energy of all frames.
sim::Band mean_power_w(const FinishedFrames& frames, double fps, const sim::Band& pj, double time_ms,
                       const sim::Band& idle_mw) {
  const double busy = fps * time_ms / frames.count / 1000;
  const sim::Band joules_per_frame = pj * (1e-12 / frames.count);
  return joules_per_frame * fps + idle_mw * (std::max(0.0, 1 - busy) / kMilliwattsPerWatt);
}

/// Estimates the power of finished frames at scaled clocks and the voltages that these need.
class OperatingPoints {
 public:
  OperatingPoints(const RunConfig& config, const FinishedFrames& frames, const sim::EnergyReport& idle)
      : config_(config),
        frames_(frames),
        idle_(idle),
        memory_mw_(hw::dram_idle_power_mw(config.gpu->dram)),
        curves_(sim::voltage_curves(config.power)),
        own_(power_scales(config)) {}

  /// True if every clock domain has a voltage curve.
  bool has_curves() const {
    return std::ranges::all_of(clock_domains(),
                               [&](const ClockDomain& d) { return curves_.contains(std::string(d.name)); });
  }

  OperatingPoint point_at(double factor) const {
    const ScaledClocks clocks = scaled_clocks(factor);
    const sim::Band idle_mw = chip_idle_mw(config_, idle_, clocks) + memory_mw_;
    return {
        factor, clocks.mhz, clocks.volt,
        mean_power_w(frames_, config_.frame.fps, energy_at(frames_.energy, clocks), frames_.time_ms / factor, idle_mw)};
  }

 private:
  ScaledClocks scaled_clocks(double factor) const {
    ScaledClocks clocks{.factor = factor};
    for (const ClockDomain& domain : clock_domains()) {
      const double hz = static_cast<double>((config_.gpu->clocks.*domain.clock).hz) * factor;
      const double volt = curves_.at(std::string(domain.name)).voltage_at(static_cast<std::uint64_t>(std::llround(hz)));
      clocks.mhz.push_back(hz / kHertzPerMegahertz);
      clocks.volt.push_back(volt);
      const sim::PowerScale scale = sim::power_scale(config_.power, volt);
      for (const std::string& block : domain.blocks) {
        const sim::PowerScale& own = own_.at(block);
        clocks.blocks[block] = {scale.dynamic / own.dynamic, scale.leakage / own.leakage};
      }
    }
    return clocks;
  }

  const RunConfig& config_;
  const FinishedFrames& frames_;
  const sim::EnergyReport& idle_;
  const sim::Band memory_mw_;
  const std::map<std::string, sim::VoltageCurve> curves_;
  const sim::PowerScales own_;
};

}  // namespace

std::vector<sim::UnitReport> idle_millisecond_reports(std::span<const sim::UnitReport> units) {
  constexpr std::uint64_t kCyclesPerMhz = 1000;
  std::vector<sim::UnitReport> idle;
  std::ranges::copy_if(units, std::back_inserter(idle), [](const sim::UnitReport& u) { return u.block != "dram"; });
  for (sim::UnitReport& unit : idle) {
    for (sim::CounterReport& counter : unit.counters) counter.value = 0;
    std::uint64_t cycles = unit.clock_mhz * kCyclesPerMhz;
    for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) {
      const bool is_idle = i < unit.reasons.size() && unit.reasons[i].kind == sim::ReasonKind::kIdle;
      unit.cycles_by_reason[i].second = is_idle ? std::exchange(cycles, 0) : 0;
    }
  }
  return idle;
}

sim::Band idle_power_mw(const RunConfig& config, std::span<const sim::UnitReport> units) {
  return chip_idle_mw(config, idle_energy(config, units), {}) + hw::dram_idle_power_mw(config.gpu->dram);
}

double idle_clock_mw(const RunConfig& config, std::span<const sim::UnitReport> units) {
  if (config.power.idle != sim::ChipIdle::kClocked) return 0;
  double pj = 0;
  for (const auto& [name, block] : idle_energy(config, units).blocks) {
    if (name != "dram") pj += block.clock.nominal;
  }
  return pj * kPicojoulesPerMillisecond;
}

bool FrameRate::is_met() const { return slowest_ms <= period_ms * (1 + kRateRounding); }

FrameRate evaluate_frame_rate(const RunConfig& config, const FinishedFrames& frames) {
  const sim::EnergyReport idle = idle_energy(config, frames.units);
  FrameRate rate;
  rate.fps = config.frame.fps;
  rate.period_ms = 1000 / rate.fps;
  rate.slowest_ms = frames.slowest_ms;
  rate.busy = frames.time_ms / frames.count / rate.period_ms;
  rate.idle_mw = chip_idle_mw(config, idle, {}) + hw::dram_idle_power_mw(config.gpu->dram);
  rate.power_w = mean_power_w(frames, rate.fps, frames.energy.total_pj, frames.time_ms, rate.idle_mw);
  rate.clock_factor = rate.slowest_ms / rate.period_ms;
  const OperatingPoints points(config, frames, idle);
  if (!rate.is_met() || !points.has_curves()) return rate;
  const double least = std::min(1.0, rate.clock_factor);
  rate.slowest = rate.best = points.point_at(least);
  for (int i = 1; i <= kOperatingPoints; ++i) {
    OperatingPoint point = points.point_at(least + (1 - least) * i / kOperatingPoints);
    if (point.power_w.nominal < rate.best->power_w.nominal) rate.best = std::move(point);
  }
  return rate;
}

namespace {

using sim::Json;

Json clocks_json(const OperatingPoint& clocks) {
  Json mhz = Json::object(), volt = Json::object();
  for (std::size_t i = 0; i < clocks.mhz.size(); ++i) {
    mhz[std::string(clock_domains()[i].name)] = clocks.mhz[i];
    volt[std::string(clock_domains()[i].name)] = clocks.volt[i];
  }
  return {{"factor", clocks.factor}, {"mhz", mhz}, {"volt", volt}, {"power_w", sim::band_json(clocks.power_w)}};
}

}  // namespace

Json frame_rate_json(const FrameRate& rate) {
  Json at_fps = {{"fps", rate.fps},
                 {"met", rate.is_met()},
                 {"period_ms", rate.period_ms},
                 {"slowest_frame_ms", rate.slowest_ms},
                 {"slack_ms", rate.slack_ms()},
                 {"busy", rate.busy},
                 {"idle_mw", sim::band_json(rate.idle_mw)},
                 {"clock_factor", rate.clock_factor}};
  if (rate.slowest) at_fps["slowest_clocks"] = clocks_json(*rate.slowest);
  if (rate.best) at_fps["best_clocks"] = clocks_json(*rate.best);
  return {{"at_fps", std::move(at_fps)},
          {"power_at_fps_w", sim::band_json(rate.power_w)},
          {"fps_margin", rate.rate_margin()}};
}

std::optional<TargetRate> target_rate(const FrameResult& run, const Json& frames, const RunConfig& config) {
  if (config.frame.fps <= 0) return std::nullopt;
  double slowest_ms = 0;
  for (const Json& frame : frames) slowest_ms = std::max(slowest_ms, frame["time_ms"].get<double>());
  return TargetRate{config, slowest_ms * run.frames / run.time_ms()};
}

Json frame_rate_json(const FrameResult& run, const TargetRate& target) {
  const double ms = run.time_ms();
  return frame_rate_json(evaluate_frame_rate(target.config, {.energy = run.energy,
                                                             .units = run.units,
                                                             .count = static_cast<double>(run.frames),
                                                             .time_ms = ms,
                                                             .slowest_ms = target.slowest_share * ms / run.frames}));
}

std::string frame_rate_text(const Json& totals) {
  const Json& at = totals["at_fps"];
  const auto number = [](const Json& value) { return sim::four_digit_text(value.get<double>()); };
  const double slack = at["slack_ms"].get<double>();
  return fmt::format("{} frames/s {}, {} W; between frames {} mW", number(at["fps"]),
                     at["met"].get<bool>() ? fmt::format("met, {} ms to spare", sim::four_digit_text(slack))
                                           : fmt::format("NOT met by {} ms", sim::four_digit_text(-slack)),
                     number(totals["power_at_fps_w"]["nominal"]), number(at["idle_mw"]["nominal"]));
}

std::string operating_points_text(const Json& totals) {
  const Json& at = totals["at_fps"];
  if (!at.contains("slowest_clocks")) {
    return at["met"].get<bool>() ? ""
                                 : fmt::format("the rate needs clocks x{} or more",
                                               sim::four_digit_text(at["clock_factor"].get<double>()));
  }
  const auto point = [](const Json& clocks) {
    std::string volt;
    for (const auto& [domain, value] : clocks["volt"].items()) {
      const std::string text = fmt::format("{:.3f}", value.get<double>());
      if (volt.find(text) == std::string::npos) volt += (volt.empty() ? "" : "/") + text;
    }
    return fmt::format("x{:.3f} at {} V {} W", clocks["factor"].get<double>(), volt,
                       sim::four_digit_text(clocks["power_w"]["nominal"].get<double>()));
  };
  return fmt::format("slowest that meet it {}, least power {} (raywatt dvfs --fps simulates them)",
                     point(at["slowest_clocks"]), point(at["best_clocks"]));
}

}  // namespace tools
