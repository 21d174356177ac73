#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/ray_machine.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "sim/sha256.h"
#include "tools/analysis/report.h"
#include "tools/analysis/top_down.h"
#include "tools/analysis/units.h"
#include "tools/host/process.h"
#include "tools/host/run_folder.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/run_job.h"
#include "tools/run/jobs.h"
#include "tools/run/run.h"

namespace tools {
namespace {

using sim::Json;

/// Returns `totals` of the report of a ray file. `listed`: number of rays in the file.
Json totals_of(const hw::RayMachine& machine, std::uint64_t listed, const std::vector<sim::UnitReport>& units,
               const sim::EnergyReport& energy) {
  const std::uint64_t rays = machine.ray_count();
  const double ms = static_cast<double>(machine.elapsed_time()) / sim::kFemtosecondsPerMillisecond;
  Json totals = {{"cycles", machine.elapsed_cycles()},
                 {"time_ms", ms},
                 {"rays", {{"total", rays}, {"hits", machine.hit_count()}, {"listed", listed}}},
                 {"traversal_steps", machine.step_count()},
                 {"dram_bytes", Units<hw::DramChannel>(units).sum_of(&hw::DramChannel::Stats::bytes)}};
  totals.update(sim::energy_json(energy));
  totals["power_w"] = sim::band_json(energy.total_pj, 1 / (sim::kPicojoulesPerMillijoule * ms));
  totals["perf"] = {{"mrays_per_s", static_cast<double>(rays) / (1e3 * ms)},
                    {"nj_per_ray", energy.total_pj.nominal / (1e3 * static_cast<double>(rays))}};
  totals["utilisation"] = {{"tni", Units<hw::Trv>(units).share(hw::Trv::CycleReason::kVisiting)},
                           {"dram", data_bus_share(units)}};
  return totals;
}

std::string rays_table(const Json& report) {
  const Json& t = report["totals"];
  std::string out = fmt::format("{}  rays of a list  ({} triangles)\n", report["scene"]["name"].get<std::string>(),
                                sim::si_text(report["scene"]["triangles"].get<double>()));
  if (report["partial"].get<bool>()) {
    out += fmt::format("PARTIAL: interrupted after {} of {} rays\n", t["rays"]["total"].get<std::uint64_t>(),
                       t["rays"]["listed"].get<std::uint64_t>());
  }
  out += "\n";
  const auto line = [&](const char* name, const std::string& value) {
    out += fmt::format("  {:<22}{}\n", name, value);
  };
  const auto count = [](const Json& n, const char* unit = "") { return sim::si_text(n.get<double>(), unit); };
  const auto band = [](const Json& s, const char* unit) {
    return fmt::format("{:.3g} / {:.3g} / {:.3g} {}  (low / nominal / high)", s["low"].get<double>(),
                       s["nominal"].get<double>(), s["high"].get<double>(), unit);
  };
  line("cycles (T&I clock)",
       fmt::format("{}  = {} ms", count(t["cycles"]), sim::four_digit_text(t["time_ms"].get<double>())));
  line("rays", fmt::format("{}, {} hit", count(t["rays"]["total"]), count(t["rays"]["hits"])));
  line("ray rate", fmt::format("{:.4g} Mrays/s", t["perf"]["mrays_per_s"].get<double>()));
  line("traversal steps", fmt::format("{}  = {:.1f} per ray", count(t["traversal_steps"]),
                                      t["traversal_steps"].get<double>() / t["rays"]["total"].get<double>()));
  line("DRAM traffic", count(t["dram_bytes"], "B"));
  line("busy", fmt::format("T&I {:.1f} %, DRAM {:.1f} %", 100 * t["utilisation"]["tni"].get<double>(),
                           100 * t["utilisation"]["dram"].get<double>()));
  line("energy", band(t["energy_mj"], "mJ"));
  line("power", band(t["power_w"], "W"));
  line("energy per ray", fmt::format("{:.3g} nJ", t["perf"]["nj_per_ray"].get<double>()));
  return out;
}

/// Returns the report of the simulation of a ray file. It covers the rays that the machine `played` has finished.
Json rays_report(const JobOptions& options, const Inputs& inputs, const RayList& list, const hw::RayMachine& played) {
  const std::vector<sim::UnitReport> units = played.unit_reports();
  const sim::EnergyReport energy =
      sim::compute_energy(units, inputs.config.energy, hw::dram_energy_events(inputs.config.gpu->dram),
                          played.elapsed_time(), power_scales(inputs.config));
  Json provenance = provenance_json(inputs, options);
  provenance["rays_sha256"] = list.sha256;
  provenance["any_hit"] = options.any_hit;
  std::vector<std::string> warnings = inputs.warnings;
  add_warnings(warnings, run_warnings(inputs.config, units));
  return {{"schema", "raywatt-rays/1"},
          {"partial", played.ray_count() < list.rays.size()},
          {"config", Json(sim::config_json(inputs.config))},
          {"scene",
           {{"name", inputs.scene.name},
            {"triangles", inputs.scene.triangles},
            {"instances", inputs.scene.instances},
            {"lights", inputs.scene.lights}}},
          {"warnings", std::move(warnings)},
          {"provenance", std::move(provenance)},
          {"totals", totals_of(played, list.rays.size(), units, energy)},
          {"units", sim::units_json(units)}};
}

}  // namespace

/// Throws InputError if keys are set that apply only to frames.
static void refuse_frame_keys(const RunConfig& config) {
  if (config.gpu->tni.predictor.enabled) {
    throw sim::InputError(
        "--rays: a list of rays has no tiles, from which a predictor learns; allowed: tni.predictor.enabled=false");
  }
  if (config.frame.start == FrameStart::kCold && config.frame.fps == 0) return;
  throw sim::InputError("--rays: a list of rays is no frame of a sequence; allowed: frame.start=cold, frame.fps=0");
}

void run_rays(const JobOptions& options) {
  const auto begin = sim::HostClock::now();
  RunFolder folder(options.out, options.force);
  Progress progress(options.progress, options.quiet);
  const RayList list = read_ray_list(options.rays);
  const Inputs inputs = load_inputs(options, &progress);
  refuse_frame_keys(inputs.config);
  check_table_names(idle_unit_reports(*inputs.config.gpu, {}, inputs.config.bvh), inputs.config);
  print_warnings(inputs.warnings, &progress);
  hw::RayMachine machine(*inputs.config.gpu, inputs.image, inputs.parents, list.rays,
                         options.any_hit ? traces::RayKind::kShadow : traces::RayKind::kPrimary,
                         [&](const hw::RayProgress& so_far) {
                           progress.set_tiles_done(so_far.blocks, so_far.rays, so_far.cycles);
                           return !is_interrupted();
                         });

  Json json;
  folder.fill([&](const RunFolder::Open& open) {
    // only if the folder has no earlier result, which a partial result must not replace
    std::optional<HoldInterrupts> hold;
    if (!folder.has_earlier_run()) hold.emplace();
    progress.expect_parts(1);
    progress.begin_part(
        "simulating", 0,
        static_cast<std::uint32_t>((list.rays.size() + hw::CoreRays::kBlock - 1) / hw::CoreRays::kBlock));
    machine.run();
    json = rays_report(options, inputs, list, machine);
    progress.finish(json["partial"].get<bool>() ? "interrupted" : "done");
    json["host"] = {
        {"wall_s", sim::seconds_since(begin)}, {"load_s", inputs.load_seconds}, {"peak_rss_mb", peak_rss_mib()}};
    sim::write_file_atomically(open() / "report.json", sim::json_lines(json));
    sim::write_file_atomically(open() / "report.txt", rays_table(json));
    sim::write_file_atomically(open() / "config.yaml", sim::dump_config(inputs.config));
    print_warnings(json, inputs.warnings.size());  // before a pending interrupt ends the process
    return fmt::format("{} of {} rays", machine.ray_count(), list.rays.size());
  });
  if (options.json) return fmt::print("{}", sim::json_lines(json["totals"]));
  if (options.quiet) return;
  fmt::print("{}\nreport:  {}\n", rays_table(json), (folder.target() / "report.json").string());
}

namespace {

constexpr std::uint64_t kRayBytes = 32, kMostRays = 1U << 26;

/// Returns why a ray is invalid; empty for a valid ray.
std::string_view invalid_ray_reason(const traces::Ray& ray) {
  const auto finite = [](const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  if (!finite(ray.origin)) return "origin is not finite";
  if (!finite(ray.direction)) return "direction is not finite";
  if (ray.direction == glm::vec3(0)) return "direction is zero";
  if (!(ray.t_min >= 0) || std::isinf(ray.t_min)) return "t_min is not a number from 0 on";
  if (!(ray.t_max >= ray.t_min)) return "t_max is less than t_min, or no number";
  return {};
}

}  // namespace

RayList read_ray_list(const std::filesystem::path& path) {
  const std::string bytes = sim::read_file(path, kMostRays * kRayBytes);
  const std::string shown = sim::printable(path.string());
  if (bytes.empty() || bytes.size() % kRayBytes != 0) {
    throw sim::InputError(
        fmt::format("{}: has {} bytes; allowed: 32 a ray (8 floats: origin, t_min, direction, "
                    "t_max), at least one ray",
                    shown, bytes.size()));
  }
  RayList list{std::vector<traces::Ray>(bytes.size() / kRayBytes), sim::sha256_hex(bytes)};
  for (std::size_t i = 0; i < list.rays.size(); ++i) {
    std::array<float, 8> n{};
    std::memcpy(n.data(), bytes.data() + i * kRayBytes, kRayBytes);
    list.rays[i] = {{n[0], n[1], n[2]}, n[3], {n[4], n[5], n[6]}, n[7]};
    const std::string_view wrong = invalid_ray_reason(list.rays[i]);
    if (!wrong.empty()) {
      throw sim::InputError(
          fmt::format("{}: ray {}: {}; allowed: finite numbers, a direction that is not zero, "
                      "0 <= t_min <= t_max (t_max may be infinite)",
                      shown, i, wrong));
    }
  }
  return list;
}

}  // namespace tools
