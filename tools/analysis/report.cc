#include "tools/analysis/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/frame/dma.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/srp.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
#include "sim/config/config.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/energy.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/top_down.h"
#include "tools/analysis/units.h"
#include "tools/host/build_info.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/frame_rate.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/sustained.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/embree_tracer.h"

namespace tools {

using sim::Json;

namespace {

struct Named {
  std::string_view begins;  ///< prefix of the kernel's name
  KernelGroup group;
};

/// Groups of kernels by the prefix of the kernel's name. Kernels without an entry belong to kTracing.
constexpr Named kGroups[] = {{"check_", KernelGroup::kCheck},
                             {"test_subpixels", KernelGroup::kCheck},
                             {"list_contrasts", KernelGroup::kCheck},
                             {"interpolate_", KernelGroup::kInterpolation},
                             {"find_suspects", KernelGroup::kCorrection},
                             {"store_identities", KernelGroup::kCorrection},
                             {"show_subpixels", KernelGroup::kCorrection},
                             {"settle_subpixels", KernelGroup::kCorrection},
                             {"propagate_subpixels", KernelGroup::kCorrection},
                             {"average_subpixels", KernelGroup::kCorrection},
                             {"average_contrasts", KernelGroup::kCorrection}};

KernelGroup group_of(std::string_view kernel) {
  for (const Named& named : kGroups) {
    if (kernel.starts_with(named.begins)) return named.group;
  }
  return KernelGroup::kTracing;
}

/// Returns the share of a kernel's cycles that belongs to a group of kernels: 0 or 1, except for fused kernels. Fused
/// kernels count by the share of their operations that come from kernels of the group.
double group_share_of_kernel(std::string_view kernel, KernelGroup group) {
  const kernels::KernelInfo* info = kernels::find_kernel(kernel);
  if (info == nullptr || info->parts.empty()) return group_of(kernel) == group ? 1 : 0;
  double all = 0, those = 0;
  for (const std::string_view part : info->parts) {
    const double ops = kernels::count_executed_ops(kernels::find_kernel(part)->graph);
    all += ops;
    if (group_of(part) == group) those += ops;
  }
  return those / all;
}

}  // namespace

std::optional<double> kernel_busy_share(const FrameResult& run, KernelGroup group) {
  double all = 0, those = 0;
  for (std::size_t k = 0; k < run.kernels.size(); ++k) {
    const auto cycles = static_cast<double>(run.kernel_use[k].cycles);
    all += cycles;
    those += cycles * group_share_of_kernel(run.kernels[k].kernel, group);
  }
  if (all == 0) return {};
  return those / all;
}

std::optional<double> starved_share(const FrameResult& run) {
  const std::uint64_t elapsed = Units<hw::Srp>(run.units).elapsed();
  double starved = 0;
  for (std::size_t k = 0; k < run.kernels.size(); ++k) {
    const std::string_view kernel = run.kernels[k].kernel;
    const double part =
        group_share_of_kernel(kernel, KernelGroup::kCheck) + group_share_of_kernel(kernel, KernelGroup::kInterpolation);
    starved += part * static_cast<double>(run.kernel_use[k].starved);
  }
  if (elapsed == 0) return {};
  return starved / static_cast<double>(elapsed);
}

namespace {

double ratio_of(std::uint64_t part, std::uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

Json named_counts(const auto& names, const auto& counts) {
  Json out = Json::object();
  for (std::size_t i = 0; i < counts.size(); ++i) out[names[i]] = counts[i];
  return out;
}

/// Returns totals.sampling of a report: counts of samples at the full rate and of traced samples, reasons for tracing,
/// and the shares of cycles spent on checks, interpolation and correction.
Json sampling_json(const FrameResult& run) {
  const kernels::Sampling& s = run.rendered.sampling;
  Json out = {{"wanted", s.wanted},         {"traced", s.traced},         {"halo", s.halo},
              {"correction", s.correction}, {"background", s.background}, {"traced_background", s.traced_background}};
  if (s.wanted > s.background) {
    out["traced_ratio_without_background"] = ratio_of(s.traced - s.traced_background, s.wanted - s.background);
  }
  const bool is_subdivided = run.program.kind == kernels::ProgramSpec::Kind::kSupersample;
  if (is_subdivided) {
    out["active"] = s.active;
    out["reasons"] = named_counts(names_of(kernels::Attribute{}), s.reasons);
    out["first_reasons"] = named_counts(names_of(kernels::Attribute{}), s.first_reasons);
    out["padding"] = s.padding;
    if (s.propagated != 0) out["propagated"] = s.propagated;
  }
  if (s.checked != 0) {
    out["checked"] = s.checked;
    out["passed"] = s.passed;
    out["similar_ratio"] = ratio_of(s.passed, s.checked);
    if (s.rough != 0) out["rough"] = s.rough;
    out["failed"] = named_counts(names_of(kernels::Check{}), s.failed);
    out["first_failed"] = named_counts(names_of(kernels::Check{}), s.first_failed);
  }
  if (!is_subdivided && s.checked == 0) return out;
  const auto add = [&](const char* key, const std::optional<double>& share) {
    if (share) out[key] = *share;
  };
  add("check_share", kernel_busy_share(run, KernelGroup::kCheck));
  add("interpolation_share", kernel_busy_share(run, KernelGroup::kInterpolation));
  add("correction_share", kernel_busy_share(run, KernelGroup::kCorrection));
  add("starved_share", starved_share(run));
  return out;
}

}  // namespace

Json tiles_json(const kernels::Sampling& sampling) {
  Json similar = Json::array();
  for (const float share : sampling.similar) similar.push_back(std::round(1e4 * share) / 1e4);
  return {{"side", sampling.tile_side}, {"similar_ratio", std::move(similar)}, {"blocks", sampling.blocks}};
}

namespace {

sim::JsonPointer pointer_to(const std::string& path) {
  std::string pointer = "/" + path;
  std::ranges::replace(pointer, '.', '/');
  return sim::JsonPointer(pointer);
}

std::string path_of(const std::string& pointer) {
  std::string path = pointer.substr(1);
  std::ranges::replace(path, '/', '.');
  return path;
}

/// Formats a metric of replicates as its mean and the relative half-width of its 95 % interval: "6.764 ± 0.12 %".
std::string mean_and_error_text(const Json& metrics, const char* path) {
  const Json& f = metrics.at(pointer_to(path));
  const double mean = f["mean"].get<double>();
  const double half = (f["high"].get<double>() - f["low"].get<double>()) / 2;
  return fmt::format("{} ± {:.2g} %", sim::four_digit_text(mean), mean == 0 ? 0 : 100 * half / mean);
}

double pixel_count_of(const ReportFile& report) {
  return report.number("resolution[0]") * report.number("resolution[1]");
}

/// Returns `totals.replicates` of a report: statistics of each noisy metric over all simulations of the run. `plain`:
/// totals of the first, unperturbed simulation.
Json replicates_json(const ComparedResult& result, const Json& plain) {
  std::vector<Json> plays = {plain};
  for (std::size_t i = 0; i < result.run.replicates.size(); ++i) {
    const FrameResult* reference = result.reference == nullptr ? nullptr : &result.reference->replicates[i];
    plays.push_back(
        totals_json({result.run.replicates[i], reference, result.error, result.worst_squared_error, result.rate}));
  }
  Json out = {{"count", plays.size()}, {"level", 0.95}, {"figures", Json::object()}};
  const Json flat = plain.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number() || !is_noisy(path_of(pointer))) continue;
    const sim::JsonPointer at(pointer);
    const auto has_it = [&](const Json& play) { return play.contains(at); };
    if (!std::ranges::all_of(plays, has_it)) continue;
    std::vector<double> values;
    for (const Json& play : plays) values.push_back(play.at(at).get<double>());
    out["figures"][at] = statistics_json(values);
  }
  return out;
}

/// Returns the statistics of a metric ("energy_mj.nominal") over a report's replicates; nullopt without replicates.
std::optional<Draws> draws_in(const ReportFile& report, const std::string& metric) {
  const std::string at = "totals.replicates.figures." + metric;
  if (!report.has(at + ".mean")) return std::nullopt;
  return Draws{static_cast<std::size_t>(report.number("totals.replicates.count")), report.number(at + ".mean"),
               report.number(at + ".deviation")};
}

}  // namespace

Json statistics_json(const std::vector<double>& values) {
  const Draws draws = draw_statistics(values);
  return {{"mean", draws.mean},
          {"deviation", draws.deviation},
          {"low", draws.mean - draws.half_width()},
          {"high", draws.mean + draws.half_width()},
          {"values", values}};
}

std::string replicates_text(const Json& replicates) {
  const Json& f = replicates["figures"];
  return fmt::format("{} runs, mean and 95 %: cycles {}, mJ {}, W {}, frames/J {}", replicates["count"].get<int>(),
                     mean_and_error_text(f, "cycles"), mean_and_error_text(f, "energy_mj.nominal"),
                     mean_and_error_text(f, "power_w.nominal"), mean_and_error_text(f, "perf.frames_per_joule_gpu"));
}

std::string replicates_table(const Json& replicates) {
  constexpr const char* kMetrics[] = {"cycles",
                                      "time_ms",
                                      "perf.fps",
                                      "perf.mrays_per_s",
                                      "dram_bytes",
                                      "utilisation.tni",
                                      "utilisation.srp",
                                      "utilisation.dram",
                                      "energy_mj.nominal",
                                      "energy_by_block_mj.tni.nominal",
                                      "power_w.nominal",
                                      "perf.frames_per_joule_gpu",
                                      "perf.frames_per_joule_tni",
                                      "perf.nj_per_ray",
                                      "relative.speedup",
                                      "relative.dram_bytes",
                                      "relative.tni_perf_per_watt",
                                      "relative.gpu_perf_per_watt"};
  sim::Table table({fmt::format("{} runs", replicates["count"].get<int>()), "mean", "deviation", "95 %, low", "high"});
  for (const char* path : kMetrics) {
    const sim::JsonPointer at = pointer_to(path);
    if (!replicates["figures"].contains(at)) continue;
    const Json& metric = replicates["figures"].at(at);
    std::vector<std::string> cells = {path};
    for (const char* part : {"mean", "deviation", "low", "high"}) {
      cells.push_back(sim::four_digit_text(metric[part].get<double>()));
    }
    table.add_row(std::move(cells));
  }
  return table.text();
}

std::optional<NoisyDifference> noisy_difference(const ReportFile& a, const ReportFile& b, const std::string& metric) {
  const double of_a = a.number("totals." + metric), of_b = b.number("totals." + metric);
  if (!is_noisy(metric) || of_a == 0 || of_b == 0) return std::nullopt;
  const std::optional<Draws> draws_a = draws_in(a, metric), draws_b = draws_in(b, metric);
  double assumed = default_noise(std::min(pixel_count_of(a), pixel_count_of(b)), metric);
  for (const auto& draws : {draws_a, draws_b}) {
    if (draws) assumed = std::max(assumed, replicate_noise(*draws));
  }
  const auto seen = [&](double value, const std::optional<Draws>& draws) {
    return draws ? MeasuredMetric{draws->mean, draws} : MeasuredMetric{value, {}, assumed};
  };
  const MeasuredMetric seen_a = seen(of_a, draws_a), seen_b = seen(of_b, draws_b);
  const MeanDifference d = difference_of(seen_a, seen_b);
  return NoisyDifference{d.value / seen_a.value, d.half_width() / seen_a.value, draws_a && draws_b,
                         std::abs(d.value) > d.half_width()};
}

namespace {

/// Divides the statistics of a metric over replicates by the machine's area in mm2.
sim::Json divide_by_area(sim::Json statistics, double mm2) {
  for (auto& [name, number] : statistics.items()) {
    if (!number.is_array()) {
      number = number.get<double>() / mm2;
      continue;
    }
    for (auto& value : number) value = value.get<double>() / mm2;
  }
  return statistics;
}

/// Adds the machine's area to the totals, by block and by kind (logic, arrays, buffers, pads), and
/// perf.frames_per_joule_per_mm2 and perf.mrays_per_s_per_mm2. No effect without an area table.
void add_area(sim::Json& totals, std::span<const sim::UnitReport> units, const RunConfig& config) {
  if (config.area.arrays.empty()) return;
  const sim::AreaReport area = sim::compute_area(units, config.energy, config.area);
  const double mm2 = area.total.nominal;
  totals["area_mm2"] = mm2;
  totals["area_band_mm2"] = sim::band_json(area.total);
  sim::AreaOfBlock all;
  for (const auto& [name, block] : area.blocks) {
    totals["area_by_block_mm2"][name] = sim::band_json(block.total());
    all.logic += block.logic;
    all.arrays += block.arrays;
    all.buffers += block.buffers;
    all.pads += block.pads;
  }
  totals["area_by_part_mm2"] = {{"logic", sim::band_json(all.logic)},
                                {"arrays", sim::band_json(all.arrays)},
                                {"buffers", sim::band_json(all.buffers)},
                                {"pads", sim::band_json(all.pads)}};
  auto& perf = totals["perf"];
  perf["frames_per_joule_per_mm2"] = perf["frames_per_joule_gpu"].get<double>() / mm2;
  perf["mrays_per_s_per_mm2"] = perf["mrays_per_s"].get<double>() / mm2;
  if (!totals.contains("replicates")) return;
  auto& replicated = totals["replicates"]["figures"]["perf"];
  replicated["frames_per_joule_per_mm2"] = divide_by_area(replicated["frames_per_joule_gpu"], mm2);
  replicated["mrays_per_s_per_mm2"] = divide_by_area(replicated["mrays_per_s"], mm2);
}

/// Ratio of simulated to requested tiles above which a warning is given. Chosen: a small excess is normal, because
/// blocks are whole tiles.
constexpr double kExcessWarningRatio = 1.5;

double tni_energy_mj(const FrameResult& run) {
  return run.energy.blocks.at("tni").total().nominal / sim::kPicojoulesPerMillijoule;
}

Json rays_json(const FrameResult& run) {
  const auto of = [&](traces::RayKind kind) { return run.rendered.rays[static_cast<std::size_t>(kind)]; };
  return {{"primary", of(traces::RayKind::kPrimary)},
          {"shadow", of(traces::RayKind::kShadow)},
          {"reflection", of(traces::RayKind::kReflection)},
          {"refraction", of(traces::RayKind::kRefraction)},
          {"total", run.rays()},
          {"continued", run.rendered.continued}};
}

/// Returns the DRAM bytes read and written, by purpose: cache lines, picture, spilled ray slots, samples and rates.
Json dram_clients_json(const FrameResult& run) {
  constexpr std::uint64_t kLine = 64;
  using Dma = hw::Dma::Stats;
  using L2 = hw::L2Bank::Stats;
  using hw::Area;
  const Units<hw::Dma> dmas(run.units);
  const Units<hw::L2Bank> banks(run.units);
  const auto moved = [&](Area area) {
    const auto written = [=](const Dma& d) -> auto& { return d.lines[static_cast<std::size_t>(area)].written; };
    const auto read = [=](const Dma& d) -> auto& { return d.lines[static_cast<std::size_t>(area)].read; };
    return kLine * (dmas.sum_of(written) + dmas.sum_of(read));
  };
  Json clients = {
      {"caches", kLine * (banks.sum_of(&L2::fills) + banks.sum_of(&L2::passed_on) + banks.sum_of(&L2::written_back))},
      {"frame_buffer", moved(Area::kPicture)},
      {"spills", moved(Area::kSpill)}};
  if (const std::uint64_t bytes = moved(Area::kSamples); bytes != 0) clients["samples"] = bytes;
  if (const std::uint64_t bytes = moved(Area::kRates); bytes != 0) clients["rates"] = bytes;
  // What remains are arrays and trees of kernels that build trees.
  std::uint64_t built = kLine * (dmas.sum_of(&Dma::lines_written) + dmas.sum_of(&Dma::lines_read));
  for (const Area area : {Area::kPicture, Area::kSpill, Area::kSamples, Area::kRates}) built -= moved(area);
  if (built != 0) clients["build"] = built;
  return clients;
}

Json interval_json(const Interval& i, double scale = 1) {
  return {{"estimate", i.estimate * scale},
          {"low", (i.estimate - i.half_width()) * scale},
          {"high", (i.estimate + i.half_width()) * scale}};
}

void add_intervals(const FrameResult& run, const Interval& cycles, const Interval& energy_pj, Json& out) {
  const double ms_per_cycle = run.time_ms() / static_cast<double>(run.cycles);
  Json time = interval_json(cycles, ms_per_cycle);
  time["estimate"] = run.time_ms();  // time_ms() is exact; the conversion from cycles would round the time
  out["cycles"] = interval_json(cycles);
  out["time_ms"] = std::move(time);
  out["energy_mj"] = interval_json(energy_pj, 1 / sim::kPicojoulesPerMillijoule);
}

/// Returns totals.sampled of a report: counts of sampled tiles, and 95 % intervals of estimates.
Json sampled_json(const FrameResult& run) {
  const SampledFrame& sampled = *run.sampled;
  Json out = {{"tiles", sampled.tiles},   {"asked", sampled.asked == 0 ? Json("auto") : Json(sampled.asked)},
              {"timed", sampled.timed},   {"measured", sampled.measured},
              {"warmed", sampled.warmed}, {"blocks", sampled.blocks},
              {"rounds", sampled.rounds}};
  add_intervals(run, sampled.cycles, sampled.energy_pj, out);
  return out;
}

/// Returns totals.sliced of a report: counts of slices, and 95 % intervals of estimates if there are several slices.
Json sliced_json(const FrameResult& run) {
  const SlicedFrame& sliced = *run.sliced;
  Json out = {{"slices", sliced.slices}, {"tiles", sliced.tiles}, {"again", sliced.again}, {"warmed", sliced.warmed}};
  if (sliced.slices > 1) add_intervals(run, sliced.cycles, sliced.energy_pj, out);
  return out;
}

/// Returns totals.representative of a report: counts of frames, and 95 % intervals of estimates.
Json representative_json(const FrameResult& run) {
  const RepresentedFrames& r = *run.represented;
  Json out = {{"frames", r.frames},
              {"simulated", r.simulated},
              {"clusters", r.cluster_sizes.size()},
              {"asked", r.asked == 0 ? Json("auto") : Json(r.asked)},
              {"draw", r.draw},
              {"rounds", r.rounds}};
  add_intervals(run, r.cycles, r.energy_pj, out);
  return out;
}

/// Returns `sequence` of a report: the cluster of each frame, and the simulated frames of each cluster. `frames`:
/// reports of the simulated frames.
Json sequence_json(const RepresentedFrames& r, const Json& frames) {
  Json clusters = Json::array();
  for (const std::uint32_t size : r.cluster_sizes) {
    clusters.push_back({{"frames", size}, {"simulated", Json::array()}, {"weight", 0.0}});
  }
  for (const Json& frame : frames) {
    Json& cluster = clusters.at(frame["cluster"].get<std::size_t>());
    cluster["simulated"].push_back(frame["frame"]);
    cluster["weight"] = cluster["weight"].get<double>() + frame["weight"].get<double>();
  }
  return {{"first_frame", r.first}, {"cluster_of_frame", r.cluster_of}, {"clusters", std::move(clusters)}};
}

Json kernels_json(const FrameResult& run) {
  Json out = Json::object();
  std::uint64_t all = 0;
  for (const hw::KernelUse& use : run.kernel_use) all += use.cycles;
  for (std::size_t k = 0; k < run.kernels.size(); ++k) {
    const hw::KernelUse& use = run.kernel_use[k];
    if (use.launches == 0) continue;
    Json& kernel = out[run.kernels[k].kernel];
    kernel = {{"launches", use.launches}, {"items", use.items},
              {"ii", run.kernels[k].ii},  {"depth", run.kernels[k].depth},
              {"cycles", use.cycles},     {"share", static_cast<double>(use.cycles) / static_cast<double>(all)},
              {"starved", use.starved}};
    if (use.idle != 0) kernel["idle"] = use.idle;
  }
  return out;
}

std::uint64_t dram_bytes(const FrameResult& run) {
  return Units<hw::DramChannel>(run.units).sum_of(&hw::DramChannel::Stats::bytes);
}

/// Returns the cost of the denoiser, and its share of all costs: those of the frame, with those of an external unit.
Json denoise_json(const FrameResult& run, const DenoiseCost& cost) {
  const double ms = static_cast<double>(cost.time) / sim::kFemtosecondsPerMillisecond;
  const double mj = cost.energy_pj / sim::kPicojoulesPerMillijoule;
  const auto bytes = static_cast<double>(cost.dram_bytes);
  const auto share = [&](double part, double of_frame) {
    return part / (cost.is_external ? of_frame + part : of_frame);
  };
  return {{"external", cost.is_external},
          {"time_ms", ms},
          {"dram_bytes", cost.dram_bytes},
          {"energy_mj", mj},
          {"time_share", share(ms, run.time_ms())},
          {"dram_share", share(bytes, static_cast<double>(dram_bytes(run)))},
          {"energy_share", share(mj, run.energy_mj())}};
}

/// Returns the members of totals that compare a run with its reference; none without a reference.
Json comparison_members(const ComparedResult& result) {
  Json members = Json::object();
  if (result.reference == nullptr) return members;
  const FrameResult &run = result.run, &reference = *result.reference;
  const auto decibels = [](double squared_error) {
    const std::optional<double> psnr = psnr_db(squared_error);
    return psnr ? Json(*psnr) : Json(nullptr);
  };
  members["psnr_db"] = decibels(result.error.squared);
  members["identical"] = members["psnr_db"].is_null();
  if (result.worst_squared_error) members["worst_psnr_db"] = decibels(*result.worst_squared_error);
  if (result.error.change) members["temporal_psnr_db"] = decibels(*result.error.change);
  const PerceivedError& perceived = result.error.perceived;
  if (perceived.frames != 0) members["flip"] = perceived.flip / perceived.frames;
  if (perceived.changes != 0) members["flicker"] = perceived.flicker / perceived.changes;
  members["reference"] = {{"cycles", reference.cycles},
                          {"top_down", time_json(top_down(reference.units, *reference.machine).gpu)}};
  const double tni_power = tni_energy_mj(run) / run.time_ms();
  members["relative"] = {
      {"speedup", ratio_of(reference.cycles, run.cycles)},
      {"traversal_steps", ratio_of(run.rendered.traversal_steps, reference.rendered.traversal_steps)},
      {"dram_bytes", ratio_of(dram_bytes(run), dram_bytes(reference))},
      {"tni_power", tni_power / (tni_energy_mj(reference) / reference.time_ms())},
      {"tni_perf_per_watt", tni_energy_mj(reference) / tni_energy_mj(run)},
      {"gpu_perf_per_watt", reference.energy_mj() / run.energy_mj()},
      {"rays", ratio_of(run.rays(), reference.rays())}};
  return members;
}

Json host_member(const ReportInput& report) {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  const ComparedResult& result = report.result;
  const RenderResult& rendered = result.run.rendered;
  const std::optional<SlicedFrame>& sliced = result.run.sliced;
  const bool is_sliced = sliced && sliced->slices > 1;
  const double timing = is_sliced ? sliced->timing_seconds : result.run.wall_seconds - rendered.waited;
  const double reference = result.reference != nullptr ? result.reference->wall_seconds : 0;
  const double replicates =
      result.run.replicate_seconds + (result.reference != nullptr ? result.reference->replicate_seconds : 0);
  const double load = report.inputs.load_seconds + report.inputs.update_seconds;
  const double wall = report.wall_seconds - load - reference - replicates;
  Json host = {{"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
               {"name", name.data()},
               {"wall_s", report.wall_seconds},
               {"load_s", load},
               {"update_s", report.inputs.update_seconds},
               {"functional_s", rendered.seconds},
               {"timing_s", std::max(0.0, timing)},
               {"rays_per_s", static_cast<double>(result.run.rays()) / wall},
               {"steps_per_s", static_cast<double>(rendered.traversal_steps) / wall},
               {"peak_rss_mb", peak_rss_mib()},
               {"threads", host_threads(report.options.threads)}};
  if (replicates != 0) host["replicates_s"] = replicates;
  if (result.run.sampled) {
    host["pilot_s"] = result.run.sampled->pilot_seconds;
    host["warming_s"] = result.run.sampled->warming_seconds;
  }
  if (result.run.represented) host["counting_s"] = result.run.represented->counting_seconds;
  if (is_sliced) host["slices_s"] = sliced->seconds;
  return {{"host", std::move(host)}};
}

void add_sustained(Json& totals, const Sustained& s) {
  totals["sustained_fps"] = s.sustained_fps;
  totals["stability"] = s.stability();
  totals["sustained"] = {{"minutes", s.seconds / 60},      {"first_fps", s.first_fps},
                         {"energy_j", s.energy_j},         {"frames", s.frames},
                         {"hottest_die_c", s.hottest.die}, {"hottest_body_c", s.hottest.body}};
}

Json work_members(const ComparedResult& result) {
  const FrameResult& run = result.run;
  return {{"cycles", run.cycles},
          {"time_ms", run.time_ms()},
          {"rays", rays_json(run)},
          {"traced_ratio", ratio_of(run.rendered.sampling.traced, run.rendered.sampling.wanted)},
          {"sampling", sampling_json(run)},
          {"traversal_steps", run.rendered.traversal_steps},
          {"dram_bytes", dram_bytes(run)},
          {"dram_bytes_by_client", dram_clients_json(run)}};
}

Json energy_members(const ComparedResult& result) {
  const FrameResult& run = result.run;
  const auto rays = static_cast<double>(run.rays());
  Json members = energy_totals_json(run.energy, {run.time_ms(), rays, static_cast<double>(run.frames)});
  Json perf = {{"fps", 1000 * run.frames / run.time_ms()}, {"mrays_per_s", rays / run.time_ms() / 1000}};
  perf.update(members["perf"]);
  members["perf"] = std::move(perf);
  return members;
}

Json time_members(const ComparedResult& result) {
  const FrameResult& run = result.run;
  const Utilisation used = utilisation_of(run.units);
  const TopDown view = top_down(run.units, *run.machine);
  const std::vector<Estimate> estimates = estimate_speedups(view.gpu);
  Json bottleneck = {{"named", largest_speedup(estimates).resource}};
  for (const Estimate& e : estimates) bottleneck["estimated_speedup"][e.resource] = e.speedup;
  return {{"utilisation", {{"tni", used.tni}, {"srp", used.srp}, {"dram", used.dram}}},
          {"top_down", top_down_json(view)},
          {"limiter", limiter_text(estimates)},
          {"bottleneck", std::move(bottleneck)},
          {"kernels", kernels_json(run)}};
}

/// Returns the members of totals that only some kinds of runs have.
Json members_of_mode(const ComparedResult& result) {
  const FrameResult& run = result.run;
  Json members = Json::object();
  if (run.sampled) members["sampled"] = sampled_json(run);
  if (run.represented) members["representative"] = representative_json(run);
  if (run.sliced) members["sliced"] = sliced_json(run);
  if (run.denoise) members["denoise"] = denoise_json(run, *run.denoise);
  return members;
}

Json rate_members(const ComparedResult& result) {
  return result.rate != nullptr ? frame_rate_json(result.run, *result.rate) : Json::object();
}

/// The members of totals in their order, except replicates. Each function returns some of them.
constexpr std::array kTotals = {work_members,    energy_members,     time_members,
                                members_of_mode, comparison_members, rate_members};

}  // namespace

Json totals_json(const ComparedResult& result) {
  Json totals = Json::object();
  for (const auto& members : kTotals) totals.update(members(result));
  if (!result.run.replicates.empty()) totals["replicates"] = replicates_json(result, totals);
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

namespace {

Json input_members(const ReportInput& report) {
  const Inputs& inputs = report.inputs;
  const FrameResult& run = report.result.run;
  std::vector<std::string> lines = inputs.warnings;
  add_warnings(lines, run_warnings(inputs.config, run.units, run.sampled));
  if (!run.sustained.empty()) add_warnings(lines, limit_warnings(run.sustained, sustain_setup(inputs.config)));
  return {{"schema", "raywatt-report/1"},
          {"partial", report.partial},
          {"program", run.program.name()},
          {"resolution", {inputs.config.render.width, inputs.config.render.height}},
          {"config", sim::config_json(inputs.config)},
          {"scene",
           {{"name", inputs.scene.name},
            {"triangles", inputs.scene.triangles},
            {"stored_triangles", inputs.stored_triangles},
            {"memory_bytes", inputs.image.layout.end},
            {"instances", inputs.scene.instances},
            {"lights", inputs.scene.lights}}},
          {"warnings", lines},
          {"provenance", provenance_json(inputs, report.options)}};
}

Json totals_member(const ReportInput& report) {
  const RunConfig& config = report.inputs.config;
  const FrameResult& run = report.result.run;
  ComparedResult result = report.result;
  const std::optional<TargetRate> rate = target_rate(run, report.frames, config);
  if (rate) result.rate = &*rate;
  Json totals = totals_json(result);
  add_area(totals, run.units, config);
  if (!run.sustained.empty()) add_sustained(totals, sustain(run.sustained, sustain_setup(config)));
  totals["extrapolated"] = technology_table_warnings(config, run.units).size();
  return {{"totals", std::move(totals)}};
}

/// Returns the frames and units of a report; if its totals are estimates, also the sequence of frames, and counters
/// with intervals.
Json part_members(const ReportInput& report) {
  const FrameResult& run = report.result.run;
  Json members = {{"frames", report.frames}, {"units", sim::units_json(run.units)}};
  if (run.represented) members["sequence"] = sequence_json(*run.represented, report.frames);
  if (!run.sampled && !run.represented) return members;
  Json& intervals = members["sampled_counters"] = Json::object();
  for (const auto& [path, interval] : run.sampled ? run.sampled->counters : run.represented->counters) {
    intervals[path] = interval_json(interval);
  }
  return members;
}

/// Functions that make report.json, in the order of its members. Each returns some of them.
constexpr std::array kReport = {input_members, totals_member, part_members, host_member};

}  // namespace

Json report_json(const ReportInput& report) {
  Json out = Json::object();
  for (const auto& members : kReport) out.update(members(report));
  return out;
}

sim::Json energy_totals_json(const sim::EnergyReport& energy, const WorkDone& work) {
  const double mj = energy.total_pj.nominal / sim::kPicojoulesPerMillijoule;
  const double tni_energy_mj = energy.blocks.at("tni").total().nominal / sim::kPicojoulesPerMillijoule;
  sim::Json out = sim::energy_json(energy);
  out["power_w"] = sim::band_json(energy.total_pj * (1 / (sim::kPicojoulesPerMillijoule * work.time_ms)));
  out["perf"] = {{"nj_per_ray", mj * 1e6 / work.rays},
                 {"frames_per_joule_gpu", 1000 * work.frames / mj},
                 {"frames_per_joule_tni", 1000 * work.frames / tni_energy_mj}};
  return out;
}

std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled) {
  std::vector<std::string> lines = technology_table_warnings(config, units);
  if (sampled && config.thermal.minutes > 0) {
    lines.emplace_back("thermal.minutes has no effect with --tile-sampling: the governor needs whole frames");
  }
  if (!sampled || sampled->asked == 0) return lines;
  const double timed = static_cast<double>(sampled->timed) / static_cast<double>(sampled->tiles);
  if (timed > kExcessWarningRatio * sampled->asked) {
    lines.push_back(
        fmt::format("--tile-sampling {:.3g}% simulated {:.3g} % of the tiles: the frame is too small for fewer, "
                    "given its start, its end and blocks of several tiles",
                    100 * sampled->asked, 100 * timed));
  }
  return lines;
}

}  // namespace tools
