#include "tools/studies/compare/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/machines/unit_kinds.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report_file.h"
#include "tools/analysis/top_down.h"
#include "tools/analysis/units.h"
#include "tools/pricing/reported_units.h"
#include "tools/run/run.h"
#include "traces/scene/images.h"

namespace tools {
namespace {

using sim::Json;

/// The main metrics of a comparison: name and report path.
constexpr std::array<std::pair<const char*, const char*>, 17> kTotals = {{
    {"cycles", "totals.cycles"},
    {"time_ms", "totals.time_ms"},
    {"fps", "totals.perf.fps"},
    {"rays", "totals.rays.total"},
    {"mrays_per_s", "totals.perf.mrays_per_s"},
    {"traversal_steps", "totals.traversal_steps"},
    {"dram_bytes", "totals.dram_bytes"},
    {"energy_mj", "totals.energy_mj.nominal"},
    {"energy_tni_mj", "totals.energy_by_block_mj.tni.nominal"},
    {"power_w", "totals.power_w.nominal"},
    {"frames_per_joule_gpu", "totals.perf.frames_per_joule_gpu"},
    {"frames_per_joule_tni", "totals.perf.frames_per_joule_tni"},
    {"nj_per_ray", "totals.perf.nj_per_ray"},
    {"power_at_fps_w", "totals.power_at_fps_w.nominal"},
    {"fps_margin", "totals.fps_margin"},
    {"area_mm2", "totals.area_mm2"},
    {"traced_ratio", "totals.traced_ratio"},
}};

/// True if the values differ by more than rounding.
bool is_different(const MetricPair& pair) {
  constexpr double kRounding = 1e-13;
  return std::abs(pair.difference()) > kRounding * std::max(std::abs(pair.a), std::abs(pair.b));
}

void sort_by_difference(std::vector<MetricPair>& pairs) {
  std::erase_if(pairs, [](const MetricPair& pair) { return !is_different(pair); });
  std::ranges::stable_sort(pairs, std::greater<>(), [](const MetricPair& pair) { return std::abs(pair.difference()); });
}

/// Returns the paths of either report that begin with `prefix`, without the prefix.
std::set<std::string> paths_below(const std::string& prefix, const ReportFile& a, const ReportFile& b) {
  std::set<std::string> out;
  for (const ReportFile* report : {&a, &b}) {
    for (auto at = report->numbers.lower_bound(prefix); at != report->numbers.end() && at->first.starts_with(prefix);
         ++at) {
      out.insert(at->first.substr(prefix.size()));
    }
  }
  return out;
}

std::vector<KeyPair> config_difference(const ReportFile& a, const ReportFile& b) {
  const auto config_of = [](const ReportFile& report) {
    return report.json.contains("config") ? flat_config(report.json["config"]) : FlatConfig{};
  };
  const FlatConfig of_a = config_of(a), of_b = config_of(b);
  FlatConfig all = of_a;
  all.insert(of_b.begin(), of_b.end());
  std::vector<KeyPair> out;
  for (const auto& [key, value] : all) {
    const auto at_a = of_a.find(key), at_b = of_b.find(key);
    KeyPair pair{key, at_a == of_a.end() ? "" : at_a->second, at_b == of_b.end() ? "" : at_b->second};
    if (pair.a != pair.b) out.push_back(std::move(pair));
  }
  return out;
}

std::vector<MetricPair> time_pairs(const ReportFile& a, const ReportFile& b) {
  const std::string prefix = "totals.top_down.gpu.";
  std::vector<MetricPair> out;
  for (const std::string& part : paths_below(prefix, a, b)) {
    if (part.starts_with("demands.")) continue;
    out.push_back({part, a.number(prefix + part) * a.number("totals.cycles"),
                   b.number(prefix + part) * b.number("totals.cycles")});
  }
  sort_by_difference(out);
  return out;
}

/// True if this entry of the report's `units` is a sum over all units of a kind (unit_sums()).
bool is_unit_sum(const ReportFile& report, const std::string& unit) { return report.has("units." + unit + ".units"); }

/// True for a cycle reason that counts otherwise unexplained time: idle, or a tile buffer that only stores data.
bool is_leftover_reason(std::string_view unit, std::string_view reason) {
  const std::optional<sim::ReasonKind> kind = hw::kind_of_reason(unit, reason);
  return kind == sim::ReasonKind::kIdle || (unit == hw::TileBuffer::kName && kind == sim::ReasonKind::kBackground);
}

/// Returns the mean number of T&I cycles that a unit of this kind spends for one cycle reason.
double mean_cycles(const ReportFile& report, const std::string& unit, const std::string& reason) {
  const double elapsed = report.number("units." + unit + ".elapsed");
  return elapsed == 0 ? 0
                      : report.number("units." + unit + ".why." + reason) / elapsed * report.number("totals.cycles");
}

std::vector<MetricPair> reason_pairs(const ReportFile& a, const ReportFile& b) {
  std::vector<MetricPair> out;
  for (const std::string& path : paths_below("units.", a, b)) {
    const std::size_t why = path.find(".why.");
    if (why == std::string::npos) continue;
    const std::string unit = path.substr(0, why), reason = path.substr(why + 5);
    if (!is_unit_sum(a, unit) && !is_unit_sum(b, unit)) continue;
    if (is_leftover_reason(unit, reason)) continue;
    out.push_back({unit + " " + reason, mean_cycles(a, unit, reason), mean_cycles(b, unit, reason)});
  }
  sort_by_difference(out);
  return out;
}

std::vector<MetricPair> block_pairs(const ReportFile& a, const ReportFile& b) {
  const std::string prefix = "totals.energy_by_block_mj.";
  std::vector<MetricPair> out;
  for (const std::string& path : paths_below(prefix, a, b)) {
    if (!path.ends_with(".nominal")) continue;
    out.push_back({path.substr(0, path.find('.')), a.number(prefix + path), b.number(prefix + path)});
  }
  sort_by_difference(out);
  return out;
}

std::vector<MetricPair> event_pairs(const ReportFile& a, const ReportFile& b) {
  const std::string prefix = "totals.energy_by_event_mj.", kinds = "totals.energy_by_kind_mj.";
  std::vector<MetricPair> out;
  for (const std::string& path : paths_below(prefix, a, b)) {
    const std::size_t dot = path.find('.');
    out.push_back({path.substr(0, dot) + " " + path.substr(dot + 1), a.number(prefix + path), b.number(prefix + path)});
  }
  for (const char* kind : {"clock", "leakage"}) {
    const std::string path = kinds + kind + ".nominal";
    out.push_back({std::string("all ") + kind, a.number(path), b.number(path)});
  }
  sort_by_difference(out);
  return out;
}

/// Returns the larger value divided by the smaller; infinity if that is 0.
double change_factor(const MetricPair& pair) {
  const auto [low, high] = std::minmax(pair.a, pair.b);
  return low == 0 ? std::numeric_limits<double>::infinity() : high / low;
}

std::vector<MetricPair> counter_pairs(const ReportFile& a, const ReportFile& b) {
  const double least = 0.01 * std::max(a.number("totals.rays.total"), b.number("totals.rays.total"));
  std::vector<MetricPair> out;
  for (const std::string& path : paths_below("units.", a, b)) {
    const std::size_t at = path.find(".counters.");
    if (at == std::string::npos) continue;
    const std::string unit = path.substr(0, at);
    if (!is_unit_sum(a, unit) && !is_unit_sum(b, unit)) continue;
    const std::string full = "units." + path;
    out.push_back({unit + " " + path.substr(at + 10), a.number(full), b.number(full)});
  }
  for (const std::string group : {"rays", "dram_bytes_by_client", "sampling"}) {
    for (const std::string& name : paths_below("totals." + group + ".", a, b)) {
      const std::string full = fmt::format("totals.{}.{}", group, name);
      out.push_back({group + " " + name, a.number(full), b.number(full)});
    }
  }
  sort_by_difference(out);
  std::erase_if(out, [&](const MetricPair& pair) { return std::abs(pair.difference()) <= least; });
  std::ranges::stable_sort(out, std::greater<>(), change_factor);
  return out;
}

/// Returns the range of frame numbers in a report as text: "2 to 10".
std::string frames_text(const ReportFile& report) {
  const auto frames = report.json.find("frames");
  if (report.has("totals.representative.frames")) {
    const double first = report.number("config.scene.first_frame"), last = report.number("config.scene.last_frame");
    return fmt::format("{} to {}", first, last);
  }
  const std::size_t count = frames != report.json.end() && frames->is_array() ? frames->size() : 0;
  const auto number = [&](std::size_t i) { return report.number(fmt::format("frames[{}].frame", i)); };
  return count == 0 ? "none" : fmt::format("{} to {}", number(0), number(count - 1));
}

std::string program_of(const ReportFile& report) {
  const auto program = report.json.find("program");
  return program != report.json.end() && program->is_string() ? program->get<std::string>() : "unknown";
}

std::vector<std::string> work_differences(const ReportFile& a, const ReportFile& b) {
  std::vector<std::string> out;
  const auto check = [&](const char* what, const std::string& of_a, const std::string& of_b) {
    if (of_a != of_b) out.push_back(fmt::format("{}: {} and {}", what, of_a, of_b));
  };
  const auto size = [](const ReportFile& r) {
    return fmt::format("{}x{}", r.number("resolution[0]"), r.number("resolution[1]"));
  };
  check("scenes", a.text("scene", "name"), b.text("scene", "name"));
  if (out.empty() && a.text("provenance", "scene_sha256") != b.text("provenance", "scene_sha256")) {
    out.emplace_back("scenes: same name, different contents (scene_sha256)");
  }
  check("programs", program_of(a), program_of(b));
  check("resolutions", size(a), size(b));
  check("frames", frames_text(a), frames_text(b));
  return out;
}

/// A ratio of two counters, each summed over all units of a kind.
struct Ratio {
  const char* name;
  std::string part;
  std::string whole;
  std::string more{};  ///< counter that is added to the denominator `whole`
  bool rest = false;   ///< the value is 1 minus the ratio
};

std::vector<Ratio> ratios_of_counters() {
  using Trv = hw::Trv::Stats;
  using Ist = hw::Ist::Stats;
  using Srp = hw::Srp::Stats;
  using L2 = hw::L2Bank::Stats;
  using Dram = hw::DramChannel::Stats;
  const auto trv = [](auto counter) { return counter_path<hw::Trv>(counter); };
  const auto ist = [](auto counter) { return counter_path<hw::Ist>(counter); };
  const auto srp = [](auto counter) { return counter_path<hw::Srp>(counter); };
  const auto l2 = [](auto counter) { return counter_path<hw::L2Bank>(counter); };
  const auto dram = [](auto counter) { return counter_path<hw::DramChannel>(counter); };
  return {{"node L1 hit rate", trv(&Trv::l1_hits), trv(&Trv::l1_accesses)},
          {"node L1 cycles a miss", trv(&Trv::l1_miss_cycles), trv(&Trv::l1_fills)},
          {"triangle L1 hit rate", ist(&Ist::l1_hits), ist(&Ist::l1_accesses)},
          {"triangle L1 cycles a miss", ist(&Ist::l1_miss_cycles), ist(&Ist::l1_fills)},
          {"data cache hit rate", srp(&Srp::cache_hits), srp(&Srp::cache_accesses)},
          {"data cache cycles a miss", srp(&Srp::cache_miss_cycles), srp(&Srp::cache_fills)},
          {"L2 hit rate", l2(&L2::hits), l2(&L2::reads)},
          {"L2 cycles a read", l2(&L2::latency), l2(&L2::reads)},
          {"DRAM row hit rate", dram(&Dram::row_hits), dram(&Dram::reads), dram(&Dram::writes)},
          {"DRAM clocks a read", dram(&Dram::read_latency), dram(&Dram::reads)},
          {"IST early exit rate", ist(&Ist::edge_tests), ist(&Ist::tests), {}, true},
          {"node visits a ray", trv(&Trv::visits), trv(&Trv::rays_in)}};
}

std::vector<MetricPair> ratio_pairs(const ReportFile& a, const ReportFile& b) {
  std::vector<MetricPair> out;
  for (const Ratio& ratio : ratios_of_counters()) {
    const auto of = [&](const ReportFile& report) {
      double whole = report.number(ratio.whole);
      if (!ratio.more.empty()) whole += report.number(ratio.more);
      const double share = whole == 0 ? 0 : report.number(ratio.part) / whole;
      return ratio.rest && whole != 0 ? 1 - share : share;
    };
    const MetricPair pair{ratio.name, of(a), of(b)};
    if (pair.a != pair.b) out.push_back(pair);
  }
  return out;
}

void compare_energy(const ReportFile& a, const ReportFile& b, Comparison& out) {
  try {
    PricedRun of_a(a), of_b(b);
    out.energy = {energy_ratio(of_a, of_b, ""), energy_ratio(of_a, of_b, "tni"), tornado_bars(of_a, of_b, "")};
  } catch (const sim::InputError& error) {
    out.no_energy = error.what();
  }
}

constexpr std::uint64_t kLargestPicture = 1ULL << 30;

double squared_error(const traces::Texture& a, const traces::Texture& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    for (const unsigned shift : {0U, 8U, 16U}) {
      const auto channel = [&](std::uint32_t texel) { return static_cast<double>((texel >> shift) & 0xff) / 255; };
      const double difference = channel(a.texels[i]) - channel(b.texels[i]);
      squares += difference * difference;
    }
  }
  return squares / (3 * static_cast<double>(a.texels.size()));
}

traces::Texture read_png(const std::filesystem::path& file) {
  const std::string bytes = sim::read_file(file, kLargestPicture);
  return traces::read_image(std::as_bytes(std::span(bytes.data(), bytes.size())), file.string());
}

/// True if the run has a picture file of this type. The content of the file is not checked.
bool has_picture(const ReportFile& report, const char* type) {
  std::error_code failed;
  return std::filesystem::exists(std::filesystem::symlink_status(report.picture(type), failed));
}

bool both_have_picture(const ReportFile& a, const ReportFile& b, const char* type) {
  return has_picture(a, type) && has_picture(b, type);
}

template <class Image>
bool have_same_size(const Image& a, const Image& b, Comparison& out) {
  if (a.width == b.width && a.height == b.height) return true;
  out.no_picture = fmt::format("sizes differ: {}x{} and {}x{}", a.width, a.height, b.width, b.height);
  return false;
}

void compare_pictures(const ReportFile& a, const ReportFile& b, Comparison& out) {
  try {
    if (both_have_picture(a, b, "exr")) {
      const traces::FloatImage of_a = traces::read_exr(a.picture("exr")), of_b = traces::read_exr(b.picture("exr"));
      if (have_same_size(of_a, of_b, out)) out.squared_error = mean_squared_error(of_a.rgb, of_b.rgb);
    } else if (both_have_picture(a, b, "png")) {
      const traces::Texture of_a = read_png(a.picture("png")), of_b = read_png(b.picture("png"));
      if (have_same_size(of_a, of_b, out)) out.squared_error = squared_error(of_a, of_b);
    } else {
      out.no_picture = "not both have one";
    }
  } catch (const sim::InputError& error) {
    out.no_picture = error.what();  // metrics are compared even without pictures
  }
}

}  // namespace

Comparison compare(const ReportFile& a, const ReportFile& b) {
  Comparison out;
  out.other_work = work_differences(a, b);
  out.config = config_difference(a, b);
  out.other_clock = std::ranges::find(out.config, "clocks.tni", &KeyPair::key) != out.config.end();
  for (const auto& [name, path] : kTotals) {
    const bool says_nothing =
        path == std::string_view("totals.traced_ratio") && a.number(path) == 1 && b.number(path) == 1;
    if (!says_nothing && (a.has(path) || b.has(path))) {
      const std::string metric = metric_name(path);
      out.metrics.push_back({name, a.number(path), b.number(path), {}, metric});
      if (!out.is_meaningless(metric)) out.metrics.back().noise = noisy_difference(a, b, metric);
    }
  }
  out.time = time_pairs(a, b);
  out.reasons = reason_pairs(a, b);
  out.blocks = block_pairs(a, b);
  out.events = event_pairs(a, b);
  out.counters = counter_pairs(a, b);
  out.ratios = ratio_pairs(a, b);
  compare_energy(a, b, out);
  compare_pictures(a, b, out);
  return out;
}

std::vector<std::string> comparison_warnings(const std::vector<ReportFile>& reports,
                                             const std::vector<Comparison>& against) {
  std::vector<std::string> out;
  const std::string first = reports.front().file.string();
  for (const ReportFile& report : reports) {
    const auto partial = report.json.find("partial");
    if (partial != report.json.end() && *partial == true) {
      out.push_back(fmt::format("{}: the run was interrupted", report.file.string()));
    }
    if (report.has("totals.sampled.tiles")) {
      out.push_back(fmt::format("{}: metrics are estimates (--tile-sampling), which may explain small differences",
                                report.file.string()));
    }
    if (report.has("totals.representative.frames")) {
      out.push_back(fmt::format("{}: metrics are estimates (--representative), which may explain small differences",
                                report.file.string()));
    }
    if (report.has("totals.sliced.cycles.estimate")) {
      out.push_back(fmt::format("{}: metrics are sums of slices (--slices), which may explain small differences",
                                report.file.string()));
    }
    if (report.has("totals.extrapolated") && report.number("totals.extrapolated") > 0) {
      out.push_back(fmt::format("{}: some metrics are extrapolated, see its warnings[]", report.file.string()));
    }
  }
  for (std::size_t i = 0; i < against.size(); ++i) {
    const std::string name = reports[i + 1].file.string();
    for (const std::string& what : against[i].other_work) {
      out.push_back(fmt::format("{} and {} did different work: {}", first, name, what));
    }
    if (against[i].other_clock) {
      out.push_back(
          fmt::format("{} and {} have different T&I clocks (clocks.tni): compare times, not cycles", first, name));
    }
    const auto model = [](const ReportFile& report) { return report.text("provenance", "model_id"); };
    if (model(reports[0]) != model(reports[i + 1])) {
      out.push_back(
          fmt::format("{} and {} were made by different models (model_id): the program may "
                      "also explain differences",
                      first, name));
    }
  }
  return out;
}

void add_replicates(ReportFile& report, std::uint32_t count, std::uint32_t threads, Progress* progress) {
  if (report.number("totals.replicates.count") >= count) return;
  const auto refuse = [&](const std::string& why) {
    throw sim::InputError(fmt::format(
        "--replicates: {}: {}; allowed: reports of complete runs by this version's model, with the scene in its place",
        sim::printable(report.file.string()), why));
  };
  if (report.json.value("partial", false)) refuse("the run was interrupted");
  if (report.has("totals.sampled.tiles")) refuse("has estimates (--tile-sampling), and replicates simulate all tiles");
  if (report.has("totals.representative.frames")) refuse("has estimates (--representative)");
  if (report.has("totals.sliced.cycles.estimate"))
    refuse("has sums of slices (--slices), and replicates simulate all tiles");
  const auto program = report.json.find("program");
  if (program == report.json.end() || !program->is_string()) refuse("has no frame program");
  JobOptions options;
  options.program = program->get<std::string>();
  options.threads = threads;
  options.replicates = count;
  sim::Json played = plain_report(load_inputs(reported_config(report), threads, progress), options, progress);
  const auto cycles = played["totals"]["cycles"].get<double>();
  if (cycles != report.number("totals.cycles")) {
    refuse(fmt::format("has {:.0f} cycles, but a repetition takes {:.0f}", report.number("totals.cycles"), cycles));
  }
  for (ReportNumber& number : report_numbers(played)) {
    if (number.path.starts_with("totals.replicates.")) report.numbers[std::move(number.path)] = number.value;
  }
  report.json["totals"]["replicates"] = std::move(played["totals"]["replicates"]);
}

namespace {

constexpr std::size_t kShown = 8;  ///< lines per list; --json has all

/// Returns a relative change as text: "+1.42 %", or "x3.19" from a factor of 2.
std::string relative_text(double relative) {
  return relative < 1 ? fmt::format("{:+.{}f} %", 100 * relative, std::abs(relative) < 0.1 ? 2 : 1)
                      : fmt::format("x{:.3g}", 1 + relative);
}

}  // namespace

std::string noise_text(const MetricPair& pair) {
  if (!pair.noise) return "";
  const NoisyDifference& n = *pair.noise;
  constexpr double kRounding = 1e-12;
  const bool is_of_means = n.measured || std::abs(n.relative - (pair.b / pair.a - 1)) > kRounding;
  if (pair.a == pair.b && !is_of_means) return "";
  const char* const verdict = n.outside ? "outside" : "within";
  if (!is_of_means) return fmt::format("{} ± {:.2g} %", verdict, 100 * n.half_width);
  return fmt::format("mean {} ± {:.2g} %, {}", relative_text(n.relative), 100 * n.half_width, verdict);
}

namespace {

std::string noise_text(const Comparison& c, const MetricPair& pair) {
  return c.is_meaningless(pair.name) ? "another clock" : noise_text(pair);
}

/// Returns a note that states whether noise is measured by replicates or assumed.
std::string noise_note(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  bool measured = false, assumed = false;
  for (const Comparison& c : against) {
    for (const MetricPair& pair : c.metrics) {
      if (!noise_text(c, pair).empty() && pair.noise) (pair.noise->measured ? measured : assumed) = true;
    }
  }
  std::string out;
  if (measured) out += "noise: differences of the means of replicates, 95 % intervals\n";
  if (!assumed) return out;
  const auto has_replicates = [](const ReportFile& report) { return report.has("totals.replicates.count"); };
  return out +
         (std::ranges::any_of(reports, has_replicates)
              ? "noise: assumed for this size of picture, or of one run's replicates if larger"
              : "noise: assumed for this size of picture") +
         "; --replicates 5 measures it\n";
}

/// Returns the name of the report's folder: "base" for "raywatt-out/base/report.json".
std::string short_name(const ReportFile& report) {
  const std::filesystem::path file = report.file.lexically_normal();
  const std::string folder = file.parent_path().filename().string();
  const bool usual = file.filename() == "report.json" && !folder.empty() && folder != "." && folder != "..";
  return sim::printable(usual ? folder : file.stem().string(), 40);
}

}  // namespace

std::string metric_value_text(const std::string& name, double value) {
  static const std::map<std::string, const char*> kUnits = {
      {"time_ms", "ms"},          {"dram_bytes", "B"},  {"energy_mj", "mJ"},
      {"energy_tni_mj", "mJ"},    {"power_w", "W"},     {"power_at_fps_w", "W"},
      {"mrays_per_s", "Mrays/s"}, {"nj_per_ray", "nJ"}, {"area_mm2", "mm2"}};
  const auto unit = kUnits.find(name);
  if (name == "dram_bytes") return sim::si_text(value, "B");
  if (unit == kUnits.end()) return sim::si_text(value);
  return fmt::format("{:.4g} {}", value, unit->second);
}

namespace {

std::string picture_text(const Comparison& c) {
  if (!c.squared_error) return sim::printable(c.no_picture);
  const std::optional<double> psnr = psnr_db(*c.squared_error);
  return psnr ? fmt::format("PSNR {:.2f} dB", *psnr) : "identical";
}

/// Replaces the names of the parts into which a core's time is divided by descriptions such as "tree misses: DRAM".
std::vector<MetricPair> describe_time_parts(std::vector<MetricPair> times) {
  for (MetricPair& time : times) time.name = describe_time_part(time.name);
  return times;
}

/// Replaces "a" by "per" in the names of ratios, which JSON keeps: "node L1 cycles a miss", "node L1 cycles per miss".
std::vector<MetricPair> with_per(std::vector<MetricPair> ratios) {
  for (MetricPair& ratio : ratios) {
    const std::size_t article = ratio.name.find(" a ");
    if (article != std::string::npos) ratio.name.replace(article, 3, " per ");
  }
  return ratios;
}

}  // namespace

std::string change_text(const MetricPair& pair) {
  if (pair.a == pair.b) return "=";
  if (pair.a == 0) return "new";
  if (pair.b == 0) return "gone";
  const double times = pair.b / pair.a;
  if (times >= 2) return fmt::format("x{:.3g}", times);
  const double percent = 100 * (times - 1);
  return fmt::format("{:+.{}f} %", percent, std::abs(percent) < 1 ? 2 : 1);
}

namespace {

std::string overview_text(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  const std::vector<std::string> names = short_names(reports);
  std::vector<std::string> header = {"", names.front()};
  for (std::size_t i = 1; i < names.size(); ++i) header.insert(header.end(), {names[i], "", "noise"});
  sim::Table table(header);
  for (const MetricPair& first : against.front().metrics) {
    std::vector<std::string> row = {first.label, metric_value_text(first.name, first.a)};
    for (const Comparison& c : against) {
      const auto pair = std::ranges::find(c.metrics, first.name, &MetricPair::name);
      if (pair == c.metrics.end()) row.insert(row.end(), {"-", "", ""});
      if (pair == c.metrics.end()) continue;
      row.insert(row.end(), {metric_value_text(pair->name, pair->b), change_text(*pair), noise_text(c, *pair)});
    }
    table.add_row(std::move(row));
  }
  std::vector<std::string> pictures = {"picture", ""};
  for (const Comparison& c : against) pictures.insert(pictures.end(), {picture_text(c), "", ""});
  table.add_row(std::move(pictures));
  return table.text() + noise_note(reports, against);
}

enum class Column : std::uint8_t { kCount, kEnergy, kRatio };

std::string cell_text(Column column, double value) {
  if (column == Column::kEnergy) return fmt::format("{:.4g}", value);
  if (column == Column::kRatio) return value <= 1 ? fmt::format("{:.1f} %", 100 * value) : fmt::format("{:.1f}", value);
  return sim::si_text(std::abs(value) < 1000 ? std::round(value) : value);
}

/// Returns a table of the first metrics of `pairs`. `whole`: sum of all differences, for percentages; 0 if unknown.
std::string pairs_table(const std::string& title, const std::vector<MetricPair>& pairs, Column column,
                        const std::vector<std::string>& names, double whole = 0) {
  if (pairs.empty()) return {};
  std::vector<std::string> header = {title, names[0], names[1], "difference", ""};
  sim::Table table(std::move(header));
  const std::size_t shown = column == Column::kRatio ? pairs.size() : std::min(pairs.size(), kShown);
  for (std::size_t i = 0; i < shown; ++i) {
    const MetricPair& pair = pairs[i];
    const double difference = pair.difference();
    std::string moved = (difference > 0 ? "+" : "") + cell_text(column, difference);
    if (column == Column::kRatio) {
      const bool is_share = std::max(pair.a, pair.b) <= 1;
      moved = fmt::format("{:+.2f}{}", is_share ? 100 * difference : difference, is_share ? " points" : "");
    }
    table.add_row({pair.name, cell_text(column, pair.a), cell_text(column, pair.b), moved,
                   whole != 0                 ? fmt::format("{:.0f} % of the change", 100 * difference / whole)
                   : column == Column::kRatio ? ""
                                              : change_text(pair)});
  }
  const std::string rest = shown < pairs.size() ? fmt::format("and {} more\n", pairs.size() - shown) : "";
  return "\n" + table.text() + rest;
}

double difference_of(const Comparison& c, const char* metric) {
  const auto found = std::ranges::find(c.metrics, metric, &MetricPair::name);
  return found == c.metrics.end() ? 0 : found->difference();
}

}  // namespace

std::string config_text(const std::vector<KeyPair>& keys) {
  if (keys.empty()) return "configurations are equal\n";
  std::string out = "configuration\n";
  const auto value = [](const std::string& text) { return text.empty() ? "none" : text; };
  for (std::size_t i = 0; i < std::min(keys.size(), 2 * kShown); ++i) {
    out += fmt::format("  {}: {} -> {}\n", keys[i].key, value(keys[i].a), value(keys[i].b));
  }
  if (keys.size() > 2 * kShown) out += fmt::format("  and {} more keys\n", keys.size() - 2 * kShown);
  return out;
}

namespace {

/// Describes the energy ratio of two runs under low, nominal and high energy tables, and the entries that change it
/// most.
std::string energy_text(const Comparison& c, const std::vector<std::string>& names) {
  if (!c.energy) return "\nno energy bands: " + sim::printable(c.no_energy, 1000) + "\n";
  sim::Table ratios({fmt::format("energy over {}", names[0]), "low tables", "nominal", "high", "median of draws",
                     "95 % interval", "less in"});
  const auto row = [&](const char* name, const EnergyRatio& r) {
    ratios.add_row({name, fmt::format("{:.4f}", r.together.low), fmt::format("{:.4f}", r.together.nominal),
                    fmt::format("{:.4f}", r.together.high), fmt::format("{:.4f}", r.drawn.median),
                    fmt::format("{:.4f} .. {:.4f}", r.drawn.from, r.drawn.to),
                    fmt::format("{:.1f} %", 100 * r.b_less)});
  };
  row("GPU with memory", c.energy->gpu);
  row("T&I alone", c.energy->tni);
  std::string out =
      fmt::format("\n{}draws: {} random energy tables, each entry between low and high\n", ratios.text(), kEnergyDraws);
  const auto energy = std::ranges::find(c.metrics, "energy_mj", &MetricPair::name);
  if (energy != c.metrics.end() && energy->noise && !energy->noise->outside) {
    out += "The interval covers the energy tables only. The difference itself is within run-to-run noise.\n";
  }
  const std::vector<TornadoBar>& bars = c.energy->tornado;
  if (bars.empty()) return out;
  sim::Table table({"entries that move it most", "at its low", "at its high"});
  for (std::size_t i = 0; i < std::min(bars.size(), kShown); ++i) {
    table.add_row({bars[i].entry, fmt::format("{:.4f}", bars[i].at_low), fmt::format("{:.4f}", bars[i].at_high)});
  }
  return out + "\n" + table.text() + (bars.size() > kShown ? fmt::format("and {} more\n", bars.size() - kShown) : "");
}

std::string explanation_text(const Comparison& c, const std::vector<std::string>& names) {
  const bool has_places = !c.time.empty();
  std::string out = fmt::format("\n{} against {}: {}", names[1], names[0], config_text(c.config));
  out += pairs_table(c.other_clock ? "cycles of an average core, each of its own clock" : "cycles of an average core",
                     describe_time_parts(c.time), Column::kCount, names, difference_of(c, "cycles"));
  out += pairs_table("cycles of an average unit", c.reasons, Column::kCount, names);
  out += pairs_table("rates and mean times", with_per(c.ratios), Column::kRatio, names);
  out += pairs_table("mJ by block", c.blocks, Column::kEnergy, names, difference_of(c, "energy_mj"));
  out += pairs_table("mJ by event", c.events, Column::kEnergy, names, difference_of(c, "energy_mj"));
  out += energy_text(c, names);
  out += pairs_table("counters that changed most", c.counters, Column::kCount, names);
  if (!has_places && c.events.empty() && c.counters.empty()) out += "\nall counters are equal\n";
  return out;
}

}  // namespace

std::vector<std::string> short_names(const std::vector<ReportFile>& reports) {
  std::vector<std::string> names;
  for (const ReportFile& report : reports) names.push_back(short_name(report));
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::ranges::count(names, names[i]) > 1) {
      for (std::size_t k = 0; k < names.size(); ++k)
        names[k] = fmt::format("{}:{}", static_cast<char>('A' + k % 26), names[k]);
      break;
    }
  }
  return names;
}

std::string comparison_text(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  const std::vector<std::string> names = short_names(reports);
  std::string out = overview_text(reports, against);
  for (std::size_t i = 0; i < against.size(); ++i) out += explanation_text(against[i], {names[0], names[i + 1]});
  return out;
}

namespace {

Json pairs_json(const std::vector<MetricPair>& pairs) {
  Json out = Json::array();
  for (const MetricPair& pair : pairs) {
    out.push_back({{"name", pair.name}, {"a", pair.a}, {"b", pair.b}, {"difference", pair.difference()}});
  }
  return out;
}

Json ratio_json(const EnergyRatio& r) {
  return {{"together", sim::band_json(r.together)},
          {"median", r.drawn.median},
          {"interval", {r.drawn.from, r.drawn.to}},
          {"less", r.b_less}};
}

Json energy_json(const Comparison& c) {
  if (!c.energy) return {{"why_not", sim::printable(c.no_energy, 1000)}};
  Json bars = Json::array();
  for (const TornadoBar& bar : c.energy->tornado) {
    bars.push_back({{"entry", bar.entry}, {"at_low", bar.at_low}, {"at_high", bar.at_high}});
  }
  return {{"draws", kEnergyDraws},
          {"seed", kEnergySeed},
          {"gpu", ratio_json(c.energy->gpu)},
          {"tni", ratio_json(c.energy->tni)},
          {"tornado", std::move(bars)}};
}

Json against_json(const Comparison& c) {
  Json config = Json::array(), metrics = Json::object();
  for (const KeyPair& key : c.config) config.push_back({{"key", key.key}, {"a", key.a}, {"b", key.b}});
  for (const MetricPair& pair : c.metrics) {
    Json& metric = metrics[pair.name];
    metric = {{"a", pair.a}, {"b", pair.b}, {"relative", pair.a == 0 ? Json() : Json(pair.b / pair.a)}};
    if (!pair.noise) continue;
    metric["noise"] = noise_json(*pair.noise);
  }
  Json picture = Json::object();
  if (c.squared_error) {
    const std::optional<double> psnr = psnr_db(*c.squared_error);
    picture = {{"identical", !psnr}, {"psnr_db", psnr ? Json(*psnr) : Json()}};
  } else {
    picture = {{"why_not", sim::printable(c.no_picture)}};
  }
  return {{"other_work", c.other_work},
          {"config", config},
          {"figures", metrics},
          {"time", pairs_json(c.time)},
          {"reasons", pairs_json(c.reasons)},
          {"ratios", pairs_json(c.ratios)},
          {"energy_by_block_mj", pairs_json(c.blocks)},
          {"energy_by_event_mj", pairs_json(c.events)},
          {"energy_ratio", energy_json(c)},
          {"counters", pairs_json(c.counters)},
          {"picture", picture}};
}

}  // namespace

Json noise_json(const NoisyDifference& noise) {
  return {{"from", noise.measured ? "replicates" : "default"},
          {"difference", noise.relative},
          {"half_width", noise.half_width},
          {"outside", noise.outside}};
}

Json comparison_json(const std::vector<ReportFile>& reports, const std::vector<Comparison>& against) {
  Json out = {{"schema", "raywatt-compare/1"},
              {"a", sim::printable(reports.front().file.string(), 4096)},
              {"against", Json::array()}};
  for (std::size_t i = 0; i < against.size(); ++i) {
    Json entry = {{"b", sim::printable(reports[i + 1].file.string(), 4096)}};
    entry.update(against_json(against[i]));
    out["against"].push_back(std::move(entry));
  }
  return out;
}

}  // namespace tools
