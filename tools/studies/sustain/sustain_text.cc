#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/table.h"
#include "tools/run/frame/power.h"
#include "tools/studies/sustain/sustain.h"

namespace tools {
namespace {

using sim::Json;

/// Joins the values of all clock domains into a text: "500/1000/500".
std::string join_domain_values(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.4g}", text.empty() ? "" : "/", value);
  return text;
}

Json temperatures_json(const sim::Temperatures& t) { return {{"die_c", t.die}, {"body_c", t.body}}; }

}  // namespace

std::string sustain_text(const SustainStudy& study) {
  const SustainSetup& setup = study.setup;
  sim::Table clocks({"clocks x", "MHz", "V", "ms", "frames/s", "steady die, C", "steady body, C"});
  for (std::size_t i = 0; i < study.steps.size(); ++i) {
    const SustainStep& step = study.steps[i];
    double seconds = 0;
    for (const SustainFrame& frame : step.frames) seconds += frame.seconds;
    const double mean = seconds / static_cast<double>(step.frames.size());
    const auto celsius = [&](double sim::Temperatures::*node) {
      return study.steady[i] ? fmt::format("{:.1f}", *study.steady[i].*node) : std::string("runs away");
    };
    clocks.add_row({fmt::format("{:.3g}", step.factor), join_domain_values(study.mhz[i]),
                    join_domain_values(study.volt[i]), sim::four_digit_text(1000 * mean),
                    sim::four_digit_text(1 / mean), celsius(&sim::Temperatures::die),
                    celsius(&sim::Temperatures::body)});
  }
  sim::Table loops({"min", "frames/s", "W", "clocks x", "least", "die, C", "body, C"});
  for (std::size_t i = 0; i < study.run.loops.size(); ++i) {
    const SustainLoop& loop = study.run.loops[i];
    loops.add_row({fmt::format("{:.3g}", static_cast<double>(i + 1) * setup.loop / 60), sim::four_digit_text(loop.fps),
                   sim::four_digit_text(loop.watt), fmt::format("{:.3f}", loop.factor),
                   fmt::format("{:.3g}", loop.least_factor), fmt::format("{:.1f}", loop.temperatures.die),
                   fmt::format("{:.1f}", loop.temperatures.body)});
  }
  const Sustained& run = study.run;
  return fmt::format(
      "clocks of T&I units / shader cores / L2, and the temperatures that each leads to if it is kept\n\n{}\n"
      "in loops of {} s; limits: die {:.4g} C, body {:.4g} C\n\n{}\n"
      "sustained {} frames/s, stability {:.1f} % (worst over best loop), {} changes of the clock\n"
      "{} frames in {:.1f} s, {} J\n",
      clocks.text(), sim::four_digit_text(setup.loop), setup.thermal.die_limit, setup.thermal.body_limit, loops.text(),
      sim::four_digit_text(run.sustained_fps), 100 * run.stability(), run.changes, run.frames, run.seconds,
      sim::four_digit_text(run.energy_j));
}

Json sustain_json(const SustainStudy& study) {
  Json steps = Json::array(), loops = Json::array();
  for (std::size_t i = 0; i < study.steps.size(); ++i) {
    const SustainStep& step = study.steps[i];
    Json mhz = Json::object(), volt = Json::object(), frames = Json::array();
    for (std::size_t d = 0; d < clock_domains().size(); ++d) {
      mhz[std::string(clock_domains()[d].name)] = study.mhz[i][d];
      volt[std::string(clock_domains()[d].name)] = study.volt[i][d];
    }
    for (const SustainFrame& f : step.frames) {
      frames.push_back({{"time_ms", 1000 * f.seconds},
                        {"dynamic_mj", 1000 * f.dynamic_j},
                        {"leakage_mw", 1000 * f.leakage_w},
                        {"memory_mj", 1000 * f.memory_j}});
    }
    steps.push_back({{"factor", step.factor},
                     {"mhz", mhz},
                     {"volt", volt},
                     {"frames", frames},
                     {"steady", study.steady[i] ? temperatures_json(*study.steady[i]) : Json(nullptr)}});
  }
  for (const SustainLoop& loop : study.run.loops) {
    loops.push_back({{"fps", loop.fps},
                     {"power_w", loop.watt},
                     {"factor", loop.factor},
                     {"least_factor", loop.least_factor},
                     {"end", temperatures_json(loop.temperatures)}});
  }
  const Sustained& run = study.run;
  return {{"schema", "raywatt-sustain/1"},
          {"first_fps", run.first_fps},
          {"sustained_fps", run.sustained_fps},
          {"stability", run.stability()},
          {"frames", run.frames},
          {"seconds", run.seconds},
          {"energy_j", run.energy_j},
          {"clock_changes", run.changes},
          {"hottest", temperatures_json(run.hottest)},
          {"loop_s", study.setup.loop},
          {"warnings", study.warnings},
          {"steps", steps},
          {"loops", loops}};
}

}  // namespace tools
