#include "tools/analysis/report.h"

#include <algorithm>
#include <array>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/frame/dma.h"
#include "hw_models/memory/l2_bank.h"
#include "shader_kernels/catalogue.h"
#include "sim/config/config.h"
#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/analysis/cost_totals.h"
#include "tools/analysis/limiter.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/replicated.h"
#include "tools/analysis/top_down.h"
#include "tools/analysis/units.h"
#include "tools/analysis/warnings.h"
#include "tools/host/build_info.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/embree_tracer.h"

namespace tools {

using sim::Json;

namespace {

double time_ms(const FrameResult& s) { return static_cast<double>(s.elapsed) / sim::kFemtosecondsPerMillisecond; }
double energy_mj(const FrameResult& s) { return s.energy.total_pj.nominal / sim::kPicojoulesPerMillijoule; }
double tni_mj(const FrameResult& s) {
  return s.energy.blocks.at("tni").total().nominal / sim::kPicojoulesPerMillijoule;
}

Json rays_json(const FrameResult& s) {
  const auto of = [&](traces::RayKind kind) { return s.function.rays[static_cast<std::size_t>(kind)]; };
  return {{"primary", of(traces::RayKind::kPrimary)},
          {"shadow", of(traces::RayKind::kShadow)},
          {"reflection", of(traces::RayKind::kReflection)},
          {"refraction", of(traces::RayKind::kRefraction)},
          {"total", s.rays()},
          {"continued", s.function.continued}};
}

/// Returns DRAM bytes by purpose: cache lines, picture, spilled ray slots and, where used, samples and rates; both
/// directions.
Json dram_clients_json(const FrameResult& s) {
  constexpr std::uint64_t kLine = 64;
  using Dma = hw::Dma::Stats;
  using L2 = hw::L2Bank::Stats;
  using hw::Area;
  const Units<hw::Dma> dmas(s.units);
  const Units<hw::L2Bank> banks(s.units);
  const auto moved = [&](Area area) {
    const auto written = [=](const Dma& d) -> auto& { return d.lines[static_cast<std::size_t>(area)].written; };
    const auto read = [=](const Dma& d) -> auto& { return d.lines[static_cast<std::size_t>(area)].read; };
    return kLine * (dmas.counted(written) + dmas.counted(read));
  };
  Json clients = {{"caches", kLine * (banks.counted(&L2::fills) + banks.counted(&L2::passed_on) +
                                      banks.counted(&L2::written_back))},
                  {"frame_buffer", moved(Area::kPicture)},
                  {"spills", moved(Area::kSpill)}};
  if (const std::uint64_t bytes = moved(Area::kSamples); bytes != 0) clients["samples"] = bytes;
  if (const std::uint64_t bytes = moved(Area::kRates); bytes != 0) clients["rates"] = bytes;
  return clients;
}

Json interval_json(const Interval& i, double scale = 1) {
  return {{"estimate", i.estimate * scale},
          {"low", (i.estimate - i.half_width()) * scale},
          {"high", (i.estimate + i.half_width()) * scale}};
}

void add_intervals(const FrameResult& s, const Interval& cycles, const Interval& energy_pj, Json& out) {
  const double ms_per_cycle = time_ms(s) / static_cast<double>(s.cycles);
  Json time = interval_json(cycles, ms_per_cycle);
  time["estimate"] = time_ms(s);  // exact
  out["cycles"] = interval_json(cycles);
  out["time_ms"] = std::move(time);
  out["energy_mj"] = interval_json(energy_pj, 1 / sim::kPicojoulesPerMillijoule);
}

/// Returns counts of sampled tiles, and 95 % intervals.
Json sampled_json(const FrameResult& s) {
  const SampledFrame& f = *s.sampled;
  Json out = {{"tiles", f.tiles},   {"asked", f.asked == 0 ? Json("auto") : Json(f.asked)},
              {"timed", f.timed},   {"measured", f.measured},
              {"warmed", f.warmed}, {"blocks", f.blocks},
              {"rounds", f.rounds}};
  add_intervals(s, f.cycles, f.energy_pj, out);
  return out;
}

/// Returns counts of slices, and 95 % intervals if there are several.
Json sliced_json(const FrameResult& s) {
  const SlicedFrame& f = *s.sliced;
  Json out = {{"slices", f.slices}, {"tiles", f.tiles}, {"again", f.again}, {"warmed", f.warmed}};
  if (f.slices > 1) add_intervals(s, f.cycles, f.energy_pj, out);
  return out;
}

double ratio(std::uint64_t part, std::uint64_t whole) { return static_cast<double>(part) / static_cast<double>(whole); }

Json perf_json(const FrameResult& s) {
  const double ms = time_ms(s);
  const auto rays = static_cast<double>(s.rays());
  return {{"fps", 1000 * s.frames / ms}, {"mrays_per_s", rays / ms / 1000}};
}

Json kernels_json(const FrameResult& s) {
  Json out = Json::object();
  std::uint64_t all = 0;
  for (const hw::KernelUse& use : s.kernel_use) all += use.cycles;
  for (std::size_t k = 0; k < s.kernels.size(); ++k) {
    const hw::KernelUse& use = s.kernel_use[k];
    if (use.launches == 0) continue;
    Json& kernel = out[s.kernels[k].kernel];
    kernel = {{"launches", use.launches}, {"items", use.items},
              {"ii", s.kernels[k].ii},    {"depth", s.kernels[k].depth},
              {"cycles", use.cycles},     {"share", static_cast<double>(use.cycles) / static_cast<double>(all)},
              {"starved", use.starved}};
    if (use.idle != 0) kernel["idle"] = use.idle;
  }
  return out;
}

std::uint64_t dram_bytes(const FrameResult& s) {
  return Units<hw::DramChannel>(s.units).counted(&hw::DramChannel::Stats::bytes);
}

void add_relative(Json& totals, const Result& result) {
  const FrameResult &run = result.run, &reference = *result.reference;
  const auto power = [](const FrameResult& s, double mj) { return mj / time_ms(s); };
  const auto per = [](std::uint64_t a, std::uint64_t b) { return static_cast<double>(a) / static_cast<double>(b); };
  const std::optional<double> psnr = psnr_db(result.squared_error);
  totals["psnr_db"] = psnr ? Json(*psnr) : Json(nullptr);
  totals["identical"] = !psnr.has_value();
  totals["reference"] = {{"cycles", reference.cycles},
                         {"top_down", time_json(top_down(reference.units, *reference.machine).gpu)}};
  totals["relative"] = {{"speedup", per(reference.cycles, run.cycles)},
                        {"traversal_steps", per(run.function.traversal_steps, reference.function.traversal_steps)},
                        {"dram_bytes", per(dram_bytes(run), dram_bytes(reference))},
                        {"tni_power", power(run, tni_mj(run)) / power(reference, tni_mj(reference))},
                        {"tni_perf_per_watt", tni_mj(reference) / tni_mj(run)},
                        {"gpu_perf_per_watt", energy_mj(reference) / energy_mj(run)},
                        {"rays", per(run.rays(), reference.rays())}};
}

Json host_json(const Report& report) {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  const Result& totals = report.totals;
  const FrontEnd::Result& function = totals.run.function;
  const std::optional<SlicedFrame>& sliced = totals.run.sliced;
  const bool is_cut = sliced && sliced->slices > 1;
  const double timing = is_cut ? sliced->timing_seconds : totals.run.wall_seconds - function.waited;
  const double reference = totals.reference != nullptr ? totals.reference->wall_seconds : 0;
  const double replicates =
      totals.run.replicate_seconds + (totals.reference != nullptr ? totals.reference->replicate_seconds : 0);
  const double load = report.inputs.load_seconds + report.inputs.update_seconds;
  const double wall = report.wall_seconds - load - reference - replicates;
  Json host = {{"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
               {"name", name.data()},
               {"wall_s", report.wall_seconds},
               {"load_s", load},
               {"update_s", report.inputs.update_seconds},
               {"functional_s", function.seconds},
               {"timing_s", std::max(0.0, timing)},
               {"rays_per_s", static_cast<double>(totals.run.rays()) / wall},
               {"steps_per_s", static_cast<double>(function.traversal_steps) / wall},
               {"peak_rss_mb", peak_rss_mib()},
               {"threads", host_threads(report.options.threads)}};
  if (replicates != 0) host["replicates_s"] = replicates;
  if (totals.run.sampled) {
    host["pilot_s"] = totals.run.sampled->pilot_seconds;
    host["warming_s"] = totals.run.sampled->warming_seconds;
  }
  if (is_cut) host["slices_s"] = sliced->seconds;
  return host;
}

Json warnings_json(const Inputs& in, const FrameResult& run) {
  Json lines = in.warnings;
  for (std::string& line : run_warnings(in.config, run.units, run.sampled)) lines.push_back(std::move(line));
  return lines;
}

}  // namespace

Json totals_json(const Result& result) {
  const FrameResult& s = result.run;
  Json energy =
      energy_totals_json(s.energy, {time_ms(s), static_cast<double>(s.rays()), static_cast<double>(s.frames)});
  Json perf = perf_json(s);
  perf.update(energy["perf"]);
  energy["perf"] = std::move(perf);
  const Utilisation used = utilisation(s.units);
  Json totals = {
      {"cycles", s.cycles},           {"time_ms", time_ms(s)},
      {"rays", rays_json(s)},         {"traced_ratio", ratio(s.function.sampling.traced, s.function.sampling.wanted)},
      {"sampling", sampling_json(s)}, {"traversal_steps", s.function.traversal_steps},
      {"dram_bytes", dram_bytes(s)},  {"dram_bytes_by_client", dram_clients_json(s)}};
  totals.update(energy);
  totals["utilisation"] = {{"tni", used.tni}, {"srp", used.srp}, {"dram", used.dram}};
  const TopDown view = top_down(s.units, *s.machine);
  totals["top_down"] = top_down_json(view);
  const std::vector<Estimate> estimates = estimate(view.gpu);
  totals["limiter"] = limiter(estimates);
  totals["bottleneck"] = {{"named", most(estimates).resource}};
  for (const Estimate& e : estimates) totals["bottleneck"]["estimated_speedup"][e.resource] = e.speedup;
  totals["kernels"] = kernels_json(s);
  if (s.sampled) totals["sampled"] = sampled_json(s);
  if (s.sliced) totals["sliced"] = sliced_json(s);
  if (result.reference != nullptr) add_relative(totals, result);
  if (!s.replicates.empty()) totals["replicates"] = replicates_json(result, totals);
  return totals;
}

double peak_rss_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

Json provenance_json(const Inputs& inputs, const JobOptions& options) {
  const BuildInfo build = build_info();
  return {{"version", build.version},
          {"git", build.git},
          {"dirty", build.dirty},
          {"compiler", build.compiler},
          {"flags", build.flags},
          {"embree", traces::embree_version()},
          {"model_id", build.model_id},
          {"config_hash", sim::config_hash(inputs.config)},
          {"scene_sha256", inputs.scene_sha256},
          {"bvh_hash", inputs.bvh_hash},
          {"argv", options.argv}};
}

Json report_json(const Report& report) {
  const Inputs& in = report.inputs;
  const FrameResult& run = report.totals.run;
  Json totals = totals_json(report.totals);
  add_area(totals, run.units, in.config);
  totals["extrapolated"] = extrapolation_warnings(in.config, run.units).size();
  Json out = {{"schema", "raywatt-report/1"},
              {"partial", report.partial},
              {"program", run.program.name()},
              {"resolution", {in.config.render.width, in.config.render.height}},
              {"config", Json(sim::config_json(in.config))},
              {"scene",
               {{"name", in.scene.name},
                {"triangles", in.scene.triangles},
                {"stored_triangles", in.stored_triangles},
                {"memory_bytes", in.image.layout.end},
                {"instances", in.scene.instances},
                {"lights", in.scene.lights}}},
              {"warnings", warnings_json(in, run)},
              {"provenance", provenance_json(in, report.options)},
              {"totals", std::move(totals)},
              {"frames", report.frames},
              {"units", sim::units_json(run.units)}};
  if (run.sampled) {
    Json& intervals = out["sampled_counters"] = Json::object();
    for (const auto& [path, interval] : run.sampled->counters) intervals[path] = interval_json(interval);
  }
  out["host"] = host_json(report);
  return out;
}

}  // namespace tools
