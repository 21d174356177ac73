#include "tools/studies/optimise/probe.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "tools/analysis/report_file.h"
#include "tools/run/run.h"

namespace tools::optimise {
namespace {

constexpr std::uint32_t kProbeSide = 32;  // pixels
constexpr double kProbeMinutes = 0.001;   // of a sustained run
constexpr std::array<std::string_view, 7> kGroupsOfScenes = {
    "kernels", "sampling", "sampled", "sliced", "bottleneck", "dram_bytes_by_client", "frames"};

bool is_in_group_of_scenes(std::string_view path) {
  const std::string name = metric_name(path);
  return std::ranges::find(kGroupsOfScenes, name.substr(0, name.find_first_of(".["))) != kGroupsOfScenes.end();
}

}  // namespace

std::vector<std::string> probe_report_paths(RunConfig config, JobOptions options) {
  const bool is_sequence = config.scene.first_frame != config.scene.last_frame;
  config.scene = {};
  config.render.width = config.render.height = kProbeSide;
  if (config.thermal.minutes > 0) config.thermal.minutes = kProbeMinutes;
  options.threads = 1;
  options.replicates = std::min(options.replicates, 2U);
  options.tile_sampling.clear();
  options.representative.clear();
  options.slices.clear();
  options.image = "full";
  ReportFile report;
  report.json = plain_report(load_inputs(config, options.threads), options);
  for (const ReportNumber& number : report_numbers(report.json)) report.numbers.emplace(number.path, number.value);
  rank_identical_pictures(report);
  if (is_sequence && !options.reference.empty()) report.numbers.emplace("totals.temporal_psnr_db", kIdenticalPsnr);
  std::vector<std::string> paths;
  for (const auto& [path, value] : report.numbers) paths.push_back(path);
  return paths;
}

bool may_depend_on_scene(std::string_view text, std::span<const std::string> paths) {
  if (is_in_group_of_scenes(text)) return true;
  if (denotes_report_path(text, paths)) return false;
  const std::size_t dot = text.rfind('.');
  if (dot == std::string_view::npos || text.starts_with("totals.")) return false;
  const std::string_view end = text.substr(dot);  // ".items", as of all kernels
  return std::ranges::any_of(
      paths, [&](const std::string& path) { return is_in_group_of_scenes(path) && path.ends_with(end); });
}

}  // namespace tools::optimise
