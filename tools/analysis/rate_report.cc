#include "tools/analysis/rate_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/analysis/report.h"
#include "tools/run/frame/power.h"

namespace tools {
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
  return TargetRate{config, slowest_ms * run.frames / time_ms(run)};
}

Json frame_rate_json(const FrameResult& run, const TargetRate& target) {
  const double ms = time_ms(run);
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
