#include "sim/report/table.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/io/json.h"
#include "tools/analysis/report.h"
#include "tools/analysis/top_down.h"
#include "tools/run/frame/frame_rate.h"

namespace tools {

using sim::Json;
using sim::si_text;

namespace {

std::string percent_text(const Json& share) { return fmt::format("{:.1f} %", 100 * share.get<double>()); }

std::string band_text(const Json& s, double scale, const char* unit) {
  return fmt::format("{:.3g} / {:.3g} / {:.3g} {}", s["low"].get<double>() * scale, s["nominal"].get<double>() * scale,
                     s["high"].get<double>() * scale, unit);
}

/// Formats the counts of samples of a program with adaptive sampling.
std::string samples_text(const Json& totals) {
  const Json& s = totals["sampling"];
  std::string out = fmt::format("{} of {} traced ({})", si_text(s["traced"].get<double>()),
                                si_text(s["wanted"].get<double>()), percent_text(totals["traced_ratio"]));
  for (const char* of_them : {"halo", "correction"}) {
    if (s[of_them] != 0) out += fmt::format(", {} for the {}", si_text(s[of_them].get<double>()), of_them);
  }
  if (s.contains("similar_ratio"))
    out += fmt::format("; {} of those compared were similar", percent_text(s["similar_ratio"]));
  return out;
}

/// Formats the most frequent reasons for tracing samples, as shares of all traced samples.
std::string tracing_reasons(const Json& s) {
  constexpr std::uint64_t kOfSubpixel = 4;  // traced samples per active sub-pixel
  std::vector<std::pair<std::uint64_t, std::string>> reasons;
  const std::uint64_t traced = s["traced"].get<std::uint64_t>();
  std::uint64_t explained = 0;
  const auto add = [&](const std::string& name, std::uint64_t samples) {
    explained += samples;
    if (samples != 0) reasons.emplace_back(samples, name);
  };
  if (s.contains("first_failed")) {
    for (const auto& [check, samples] : s["first_failed"].items()) add(check, samples.get<std::uint64_t>());
  } else {
    for (const auto& [name, active] : s["first_reasons"].items()) add(name, kOfSubpixel * active.get<std::uint64_t>());
  }
  for (const char* of_them : {"halo", "correction"}) add(of_them, s[of_them].get<std::uint64_t>());
  add(s.contains("first_failed") ? "references" : "centres", traced - explained);
  std::ranges::stable_sort(reasons, std::ranges::greater{}, &std::pair<std::uint64_t, std::string>::first);
  std::string out;
  for (const auto& [samples, name] : reasons) {
    if (!out.empty()) out += ", ";
    out += fmt::format("{} {}", name, percent_text(static_cast<double>(samples) / static_cast<double>(traced)));
  }
  return out;
}

/// Formats the half-width of a metric's 95 % interval; empty if the metric is not estimated.
std::string half_interval(const Json& totals, const char* metric) {
  const auto has = [&](const char* key) { return totals.contains(key); };
  const char* const by = has("sampled") ? "sampled" : has("representative") ? "representative" : "sliced";
  if (!totals.contains(by) || !totals[by].contains(metric)) return "";
  const Json& i = totals[by][metric];
  const double half = (i["high"].get<double>() - i["low"].get<double>()) / 2;
  return fmt::format("  ± {:.1f} %", 100 * half / i["estimate"].get<double>());
}

std::string representative_text(const Json& r) {
  return fmt::format("{} of {} frames simulated, of {} clusters; ± is the half-width of a 95 % interval",
                     r["simulated"].get<int>(), r["frames"].get<int>(), r["clusters"].get<int>());
}

/// Formats which frames of each cluster were simulated.
std::string clusters_text(const Json& sequence) {
  sim::Table table({"cluster", "frames", "simulated"});
  const Json& clusters = sequence["clusters"];
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    std::string numbers;
    for (const Json& frame : clusters[c]["simulated"]) {
      numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", frame.get<int>());
    }
    table.add_row({std::to_string(c), std::to_string(clusters[c]["frames"].get<int>()), numbers});
  }
  return table.text();
}

std::string slices_text(const Json& sliced) {
  const int count = sliced["slices"].get<int>();
  return fmt::format("{}{}", count, count > 1 ? ", added up; ± is the half-width of a 95 % interval" : "");
}

/// Formats the heading of a report: scene, picture size, program, and a warning if the run is incomplete.
std::string heading_text(const Json& report) {
  const Json& frames = report["frames"];
  std::string out;
  if (!frames.empty() && frames.front().contains("finished_tiles")) {
    out = fmt::format(
        "PARTIAL: interrupted after {} of {} tiles; frame rate and efficiency are those of the finished tiles\n",
        frames.front()["finished_tiles"].get<int>(), frames.front()["tiles"].get<int>());
  } else if (report["partial"].get<bool>()) {
    out = "PARTIAL: interrupted before the last frame or the reference\n";
  }
  return out + fmt::format("{}  {}x{}  {}  ({} triangles)\n\n", report["scene"]["name"].get<std::string>(),
                           report["resolution"][0].get<int>(), report["resolution"][1].get<int>(),
                           report["program"].get<std::string>(), si_text(report["scene"]["triangles"].get<double>()));
}

/// Formats the DRAM traffic of a run by purpose.
std::string dram_traffic(const Json& totals) {
  const auto bytes = [](const Json& n) { return si_text(n.get<double>(), "B"); };
  const Json& clients = totals["dram_bytes_by_client"];
  std::string out = fmt::format("{}  (caches {}, frame buffer {}, spilled ray slots {}", bytes(totals["dram_bytes"]),
                                bytes(clients["caches"]), bytes(clients["frame_buffer"]), bytes(clients["spills"]));
  for (const char* more : {"samples", "rates"}) {
    if (clients.contains(more)) out += fmt::format(", {} {}", more, bytes(clients[more]));
  }
  return out + ")";
}

/// Formats the traversal steps per ray; empty for a frame without rays, in which the rasteriser finds all visible
/// surfaces.
std::string steps_per_ray(const Json& totals) {
  const auto rays = totals["rays"]["total"].get<double>();
  return rays > 0 ? fmt::format("  = {:.1f} per ray", totals["traversal_steps"].get<double>() / rays) : "";
}

std::string efficiency_text(const Json& totals) {
  const Json& perf = totals["perf"];
  std::string out = fmt::format("{} frames/J GPU with memory, {} frames/J T&I alone",
                                sim::four_digit_text(perf["frames_per_joule_gpu"].get<double>()),
                                sim::four_digit_text(perf["frames_per_joule_tni"].get<double>()));
  if (totals["rays"]["total"].get<double>() > 0)
    out += fmt::format(", {:.2f} nJ per ray", perf["nj_per_ray"].get<double>());
  return out;
}

std::string area_text(const Json& totals) {
  return fmt::format("{}, {} frames/J and {} Mrays/s per mm2", band_text(totals["area_band_mm2"], 1, "mm2"),
                     sim::four_digit_text(totals["perf"]["frames_per_joule_per_mm2"].get<double>()),
                     sim::four_digit_text(totals["perf"]["mrays_per_s_per_mm2"].get<double>()));
}

std::string sustained_text(const Json& totals) {
  const Json& s = totals["sustained"];
  return fmt::format("{} frames/s after {:.4g} minutes, stability {:.1f} %, die {:.1f} C and body {:.1f} C at most",
                     sim::four_digit_text(totals["sustained_fps"].get<double>()), s["minutes"].get<double>(),
                     100 * totals["stability"].get<double>(), s["hottest_die_c"].get<double>(),
                     s["hottest_body_c"].get<double>());
}

/// Explains why a run with fewer traversal steps than its reference is slower: names the cause whose share of a core's
/// time grew most. Empty for other runs.
std::string slowdown_text(const Json& t) {
  const Json &relative = t["relative"], &reference = t["reference"];
  const double steps = relative["traversal_steps"].get<double>();
  if (relative["speedup"].get<double>() >= 1 || steps >= 1) return "";
  const double before = reference["cycles"].get<double>(), after = t["cycles"].get<double>();
  const GrownPart grown = most_grown_part({reference["top_down"], before}, {t["top_down"]["gpu"], after});
  return fmt::format("{} take {} more cycles, the frame {} more, with x{:.3f} of the traversal steps", grown.name,
                     si_text(grown.cycles), si_text(after - before), steps);
}

/// Formats a PSNR, which is null for identical pictures.
std::string decibel_text(const Json& psnr) {
  return psnr.is_null() ? "identical" : fmt::format("{:.2f} dB", psnr.get<double>());
}

std::string overview_text(const Json& report) {
  const Json& t = report["totals"];
  const Json& rays = t["rays"];
  const auto count = [](const Json& n) { return si_text(n.get<double>()); };
  const Json& frames = report["frames"];
  std::string out = heading_text(report);
  const auto line = [&](const char* name, const std::string& value) {
    out += fmt::format("  {:<22}{}\n", name, value);
  };
  if (frames.size() > 1) {
    const auto by_cycles = [](const Json& a, const Json& b) {
      return a["cycles"].get<double>() < b["cycles"].get<double>();
    };
    const auto [least, most] = std::minmax_element(frames.begin(), frames.end(), by_cycles);
    line("frames",
         fmt::format("{} to {}, {}; {} to {} cycles each", frames.front()["frame"].get<int>(),
                     frames.back()["frame"].get<int>(), t.contains("representative") ? "some of them" : "added up",
                     count((*least)["cycles"]), count((*most)["cycles"])));
  }
  if (t.contains("representative")) line("representative", representative_text(t["representative"]));
  if (t.contains("sampled")) {
    const int timed = t["sampled"]["timed"].get<int>(), tiles = t["sampled"]["tiles"].get<int>();
    const char* const rest = timed < tiles ? "; the rest is estimated, ± is the half-width of a 95 % interval" : "";
    line("sampled", fmt::format("{} of {} tiles simulated{}", timed, tiles, rest));
  }
  if (t.contains("sliced")) line("slices", slices_text(t["sliced"]));
  line("cycles (T&I clock)",
       fmt::format("{}  = {} ms  = {} frames/s{}", count(t["cycles"]), sim::four_digit_text(t["time_ms"].get<double>()),
                   sim::four_digit_text(t["perf"]["fps"].get<double>()), half_interval(t, "cycles")));
  line("rays", fmt::format("{}  ({} primary, {} shadow, {} reflection, {} refraction)", count(rays["total"]),
                           count(rays["primary"]), count(rays["shadow"]), count(rays["reflection"]),
                           count(rays["refraction"])));
  if (t["sampling"].contains("checked") || t["sampling"].contains("active")) {
    line("samples", samples_text(t));
    line("traced because of", tracing_reasons(t["sampling"]));
  }
  line("ray rate", si_text(1e6 * t["perf"]["mrays_per_s"].get<double>(), "rays/s"));
  line("traversal steps", count(t["traversal_steps"]) + steps_per_ray(t));
  line("DRAM traffic", dram_traffic(t));
  line("busy", fmt::format("T&I {}, SRP {}, DRAM {}", percent_text(t["utilisation"]["tni"]),
                           percent_text(t["utilisation"]["srp"]), percent_text(t["utilisation"]["dram"])));
  line("time goes to", top_down_text(t["top_down"]["gpu"]));
  line("limited by (estimate)", t["limiter"].get<std::string>());
  if (t.contains("denoise")) {
    const Json& d = t["denoise"];
    line("denoiser",
         fmt::format("{} of the time, {} of the energy, {} of the DRAM traffic", percent_text(d["time_share"]),
                     percent_text(d["energy_share"]), percent_text(d["dram_share"])));
  }
  line("energy", band_text(t["energy_mj"], 1, "mJ  (low / nominal / high)") + half_interval(t, "energy_mj"));
  line("power", band_text(t["power_w"], 1, "W"));
  line("efficiency", efficiency_text(t));
  if (t.contains("at_fps")) {
    line("at the frame rate", frame_rate_text(t));
    if (const std::string points = operating_points_text(t); !points.empty()) line("clocks for it", points);
  }
  if (t.contains("area_mm2")) line("area", area_text(t));
  if (t.contains("sustained")) line("sustained", sustained_text(t));
  if (t.contains("replicates")) line("replicates", replicates_text(t["replicates"]));
  if (t.contains("relative")) {
    const Json& r = t["relative"];
    line("against reference",
         fmt::format(
             "speed x{:.2f}, rays x{:.3f}, DRAM traffic x{:.2f}, performance per watt T&I x{:.2f}, GPU x{:.2f}, "
             "PSNR {}",
             r["speedup"].get<double>(), r["rays"].get<double>(), r["dram_bytes"].get<double>(),
             r["tni_perf_per_watt"].get<double>(), r["gpu_perf_per_watt"].get<double>(), decibel_text(t["psnr_db"])));
    if (t.contains("temporal_psnr_db")) {
      line("in the worst frame", fmt::format("PSNR {}; of the change since the frame before {}",
                                             decibel_text(t["worst_psnr_db"]), decibel_text(t["temporal_psnr_db"])));
    }
    line("reference's time", top_down_text(t["reference"]["top_down"]));
    if (const std::string why = slowdown_text(t); !why.empty()) line("slower because", why);
  }
  return out;
}

std::string energy_table(const Json& totals) {
  sim::Table table({"energy", "low mJ", "nominal mJ", "high mJ", "share"});
  const double all = totals["energy_mj"]["nominal"].get<double>();
  const auto row = [&](const std::string& name, const Json& s) {
    const double nominal = s["nominal"].get<double>();
    table.add_row({name, sim::four_digit_text(s["low"].get<double>()), sim::four_digit_text(nominal),
                   sim::four_digit_text(s["high"].get<double>()), fmt::format("{:.1f} %", 100 * nominal / all)});
  };
  for (const auto& [block, s] : totals["energy_by_block_mj"].items()) row(block, s);
  row("total", totals["energy_mj"]);
  for (const auto& [kind, s] : totals["energy_by_kind_mj"].items()) row("of it " + kind, s);
  return table.text();
}

std::string kernel_table(const Json& kernels) {
  sim::Table table({"kernel", "launches", "items", "II", "depth", "cycles", "share of SRP"});
  for (const auto& [name, k] : kernels.items()) {
    table.add_row({name, si_text(k["launches"].get<double>()), si_text(k["items"].get<double>()),
                   std::to_string(k["ii"].get<int>()), std::to_string(k["depth"].get<int>()),
                   si_text(k["cycles"].get<double>()), percent_text(k["share"])});
  }
  return table.text();
}

}  // namespace

std::string report_table(const Json& report) {
  const Json& totals = report["totals"];
  std::string out = overview_text(report) + "\n";
  if (totals.contains("replicates")) out += replicates_table(totals["replicates"]) + "\n";
  if (report.contains("sequence")) out += clusters_text(report["sequence"]) + "\n";
  return out + energy_table(totals) + "\n" + kernel_table(totals["kernels"]);
}

}  // namespace tools
