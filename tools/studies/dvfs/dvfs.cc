#include "tools/studies/dvfs/dvfs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/run/frame/frame_rate.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/run_job.h"
#include "traces/scene/did_you_mean.h"

namespace tools {
namespace {

constexpr double kHzPerMhz = 1e6;
/// Relative tolerance for rounding when a frame time is compared with the period.
constexpr double kPeriodRounding = 1e-9;

void check_domains(const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const ClockDomain& domain : clock_domains()) known.emplace_back(domain.name);
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) != known.end()) continue;
    throw sim::InputError(fmt::format("--clocks: there is no clock domain '{}'{}; allowed: {}", sim::printable(name),
                                      traces::did_you_mean(name, known), fmt::join(known, ", ")));
  }
}

DvfsPoint dvfs_point_of(double factor, const RunConfig& config, const FrameResult& s) {
  DvfsPoint point{
      .factor = factor, .mhz = {}, .volt = {}, .mj = s.energy.total_pj * (1 / sim::kPicojoulesPerMillijoule)};
  for (const ClockDomain& domain : clock_domains()) {
    point.mhz.push_back(static_cast<double>((config.gpu->clocks.*domain.clock).hz) / kHzPerMhz);
    point.volt.push_back(voltage_needed(config, domain));
  }
  point.cycles = s.cycles;
  point.ms = static_cast<double>(s.elapsed) / sim::kFemtosecondsPerMillisecond;
  point.idle_mw = idle_power_mw(config, s.units).nominal;
  return point;
}

}  // namespace

void find_special_points(DvfsCurve& curve, double period_ms) {
  curve.period_ms = period_ms;
  curve.energy_optimal = curve.race_to_idle = curve.least_a_period = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    DvfsPoint& point = curve.points[i];
    const bool meets = point.ms <= period_ms * (1 + kPeriodRounding);
    point.period_mj = meets ? point.mj.nominal + point.idle_mw * std::max(0.0, period_ms - point.ms) / 1000 : -1;
    if (point.mj.nominal < curve.points[curve.energy_optimal].mj.nominal) curve.energy_optimal = i;
    if (point.ms < curve.points[curve.race_to_idle].ms) curve.race_to_idle = i;
    const double least = curve.points[curve.least_a_period].period_mj;
    if (meets && (least < 0 || point.period_mj < least)) curve.least_a_period = i;
  }
}

namespace {

/// Ratio of neighbouring clock factors below which the search for the best clocks stops.
constexpr double kFactorStep = 1.005;

/// Adds the geometric mean of the clock factors of points `i` and `k` to `out`, unless the points are close.
void add_middle_factor(const DvfsCurve& curve, std::size_t i, std::size_t k, std::vector<double>& out) {
  const double low = curve.points[i].factor, high = curve.points[k].factor;
  if (high / low > kFactorStep) out.push_back(std::sqrt(low * high));
}

/// Records a frame once and simulates it at different clock frequencies.
class ClockScan {
 public:
  ClockScan(const Inputs& inputs, const DvfsOptions& options, Progress* progress)
      : inputs_(inputs),
        options_(options),
        frame_(inputs, kernels::parse_program(options.job.program), "dvfs", options.job.threads, progress) {}

  void add_points(const std::vector<double>& factors, DvfsCurve& curve) {
    std::vector<RunConfig> configs;
    for (const double factor : factors) {
      configs.push_back(
          config_at_clocks(inputs_.config, options_.domains, factor, fmt::format("--factors {}", factor)));
    }
    const std::vector<FrameResult> runs = frame_.simulate(configs);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      curve.points.push_back(dvfs_point_of(factors[i], configs[i], runs[i]));
      add_warnings(curve.warnings, technology_table_warnings(configs[i], runs[i].units));
    }
    std::ranges::sort(curve.points, {}, &DvfsPoint::factor);
  }

 private:
  const Inputs& inputs_;
  const DvfsOptions& options_;
  const RecordedFrame frame_;
};

}  // namespace

std::vector<double> next_clock_factors(const DvfsCurve& curve) {
  std::vector<double> out;
  const auto meets = [&](std::size_t i) { return curve.points[i].period_mj >= 0; };
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    if (meets(i) && !meets(i - 1)) add_middle_factor(curve, i - 1, i, out);
  }
  const std::size_t best = curve.least_a_period;
  if (best > 0) add_middle_factor(curve, best - 1, best, out);
  if (best + 1 < curve.points.size()) add_middle_factor(curve, best, best + 1, out);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

DvfsCurve dvfs_curve(const DvfsOptions& options, Progress* progress) {
  check_domains(options.domains);
  std::vector<double> factors = options.factors;
  std::ranges::sort(factors);
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  JobOptions job = options.job;
  job.sets.emplace_back("power.voltage=dvfs");  // every frequency has its own voltage
  job.sets.insert(job.sets.begin(), "frame.start=warm");
  const Inputs inputs = load_inputs(job, progress);
  print_warnings(inputs.warnings, progress);
  check_table_names(idle_unit_reports(*inputs.config.gpu, {}, inputs.config.bvh), inputs.config);
  DvfsCurve curve;
  curve.warnings = inputs.warnings;
  if (progress != nullptr) progress->expect_parts(static_cast<std::uint32_t>(factors.size()) + 1);
  ClockScan scan(inputs, options, progress);
  scan.add_points(factors, curve);
  double slowest = 0;
  for (const DvfsPoint& point : curve.points) slowest = std::max(slowest, point.ms);
  const double fps = options.fps > 0 ? options.fps : inputs.config.frame.fps;
  const auto choose = [&] { find_special_points(curve, fps > 0 ? 1000 / fps : slowest); };
  choose();
  if (fps > 0 && curve.points[curve.least_a_period].period_mj >= 0) {
    for (std::vector<double> more; !(more = next_clock_factors(curve)).empty(); choose()) scan.add_points(more, curve);
    const auto met = std::ranges::find_if(curve.points, [](const DvfsPoint& p) { return p.period_mj >= 0; });
    curve.slowest_met = static_cast<std::size_t>(met - curve.points.begin());
  }
  print_warnings({curve.warnings.begin() + static_cast<std::ptrdiff_t>(inputs.warnings.size()), curve.warnings.end()},
                 progress);
  return curve;
}

namespace {

using sim::Json;

std::string remarks_on_point(const DvfsCurve& curve, std::size_t i) {
  std::string marks;
  const auto mark = [&](bool is, const char* name) {
    if (is) marks += (marks.empty() ? "" : ", ") + std::string(name);
  };
  mark(i == curve.slowest_met, i > 0 ? "slowest that meets the rate" : "lowest factor, meets the rate");
  mark(i == curve.energy_optimal, "energy-optimal");
  mark(i == curve.race_to_idle && curve.points[i].period_mj >= 0, "race to idle");
  mark(i == curve.least_a_period && curve.points[i].period_mj >= 0, "least per period");
  return marks;
}

}  // namespace

std::string dvfs_text(const DvfsCurve& curve) {
  sim::Table table({"clocks x", "MHz", "V", "ms", "frames/s", "W", "mJ per frame", "frames/J", "mJ per period", ""});
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const DvfsPoint& p = curve.points[i];
    std::string mhz, volt;
    for (std::size_t d = 0; d < p.mhz.size(); ++d) {
      mhz += fmt::format("{}{:.4g}", d == 0 ? "" : "/", p.mhz[d]);
      volt += fmt::format("{}{:.3f}", d == 0 ? "" : "/", p.volt[d]);
    }
    table.add_row({fmt::format("{:.4g}", p.factor), mhz, volt, sim::four_digit_text(p.ms),
                   sim::four_digit_text(p.frames_per_second()), sim::four_digit_text(p.power_w()),
                   sim::four_digit_text(p.mj.nominal), sim::four_digit_text(1000 / p.mj.nominal),
                   p.period_mj < 0 ? std::string("too slow") : sim::four_digit_text(p.period_mj),
                   remarks_on_point(curve, i)});
  }
  const bool is_met = curve.points[curve.least_a_period].period_mj >= 0;
  return fmt::format(
      "clocks and voltages of T&I units / shader cores / L2; the memory clock is constant\n\n{}\n"
      "a period is {} ms, {} frames/s: a frame, then idle{}\n",
      table.text(), sim::four_digit_text(curve.period_ms), sim::four_digit_text(1000 / curve.period_ms),
      is_met ? "" : "; no clock of the curve is fast enough");
}

Json dvfs_json(const DvfsCurve& curve) {
  Json points = Json::array();
  for (const DvfsPoint& p : curve.points) {
    Json mhz = Json::object(), volt = Json::object();
    for (std::size_t d = 0; d < p.mhz.size(); ++d) {
      mhz[std::string(clock_domains()[d].name)] = p.mhz[d];
      volt[std::string(clock_domains()[d].name)] = p.volt[d];
    }
    points.push_back({{"factor", p.factor},
                      {"mhz", mhz},
                      {"volt", volt},
                      {"cycles", p.cycles},
                      {"time_ms", p.ms},
                      {"fps", p.frames_per_second()},
                      {"energy_mj", sim::band_json(p.mj)},
                      {"power_w", p.power_w()},
                      {"idle_mw", p.idle_mw},
                      {"period_mj", p.period_mj < 0 ? Json(nullptr) : Json(p.period_mj)}});
  }
  Json out = {
      {"schema", "raywatt-dvfs/1"},
      {"period_ms", curve.period_ms},
      {"energy_optimal", curve.energy_optimal},
      {"race_to_idle", curve.race_to_idle},
      {"least_a_period", curve.points[curve.least_a_period].period_mj < 0 ? Json(nullptr) : Json(curve.least_a_period)},
      {"warnings", curve.warnings},
      {"points", points}};
  if (curve.slowest_met) out["slowest_met"] = *curve.slowest_met;
  return out;
}

}  // namespace tools
