#include "tools/run/stored_frames.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "shader_kernels/catalogue.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/run/frame/host_time.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/replay_program.h"
#include "tools/run/frame/trace_header.h"
#include "tools/sampling/tile_sampling.h"
#include "traces/accel/bvh_config.h"

namespace tools {
namespace {

using Part = traces::TraceReader::Part;

constexpr double kLargestSquaredError = 4;  ///< mean squared error of changes that are opposite in every channel

std::vector<traces::KernelId> kernels_of(const traces::Json& names) {
  std::vector<traces::KernelId> ids;
  for (const traces::Json& name : names) {
    const kernels::KernelInfo* kernel = kernels::find_kernel(name.get<std::string>());
    if (kernel == nullptr) {
      throw sim::InputError(fmt::format("has a kernel '{}', which this program has not; see raywatt kernels list",
                                        sim::printable(name.get<std::string>())));
    }
    ids.push_back(kernel->id);
  }
  if (ids.empty()) throw sim::InputError("has no kernels");
  return ids;
}

/// Sets those parts of a memory image that the machine needs from a recorded BVH.
void fill_recorded_bvh(const traces::TileScope& scope, const traces::BvhConfig& config, traces::MemoryImage& image) {
  const bool has_two_levels = !scope.links.roots.empty();
  if (has_two_levels && config.instances == traces::InstanceLevels::kFlatten) {
    throw sim::InputError("has a tree of two levels, and bvh.instances is flatten; allowed: two_level");
  }
  const std::uint32_t stored_slots = scope.links.is_wide() ? scope.links.slots : 0;
  const std::uint32_t slots = !config.is_wide()                            ? 0
                              : config.format == traces::NodeFormat::kCw80 ? traces::kMaxWidth
                                                                           : config.width;
  if (stored_slots != slots) {
    throw sim::InputError(
        fmt::format("has a tree with {} slots per wide node, and bvh.width and bvh.format mean {} (0: "
                    "binary)",
                    stored_slots, slots));
  }
  const bool has_records = !scope.links.begins_record.empty();
  if (scope.counts.triangles != 0 && has_records == (config.leaf == traces::LeafFormat::kTriangles)) {
    throw sim::InputError("has leaf records that bvh.leaf does not describe");
  }
  image = {};
  for (const auto& children : scope.links.nodes) std::ranges::copy(children, image.nodes.emplace_back().child);
  for (const auto& children : scope.links.wide_nodes) {
    std::ranges::copy(children, image.wide_nodes.emplace_back().child);
  }
  image.begins_record = scope.links.begins_record;
  image.leaf_format = config.leaf;
  if (image.is_wide()) {
    image.wide_format = config.node_format();
    image.width = config.width;
    image.child_order = config.order;
  }
  for (const std::uint32_t root : scope.links.roots) image.instances.emplace_back().root = root;
  std::vector<std::uint32_t> roots = scope.links.roots;
  std::ranges::sort(roots);
  const auto end = std::unique(roots.begin(), roots.end());
  for (auto root = roots.begin(); root != end && *root != traces::kNone; ++root) {
    image.trees.push_back({.first_node = *root});
  }
  // The machine needs to know that there is a grid, not its position.
  if (config.box_numbers() == traces::BoxNumbers::kHybrid) image.grid.emplace(image.lower, image.upper);
  image.layout = traces::layout_of(scope.counts, image, config);
}

}  // namespace

double StoredFrames::recorded_steps() const {
  double steps = 0;
  for (const traces::TraceReader::Part& part : trace_.parts()) {
    const bool says = part.result.contains("traversal_steps") && part.result["traversal_steps"].is_number_unsigned();
    if (says) steps += part.result["traversal_steps"].get<double>();
  }
  return steps;
}

StoredFrames::StoredFrames(const std::filesystem::path& file, const JobOptions& options)
    : StoredFrames(
          file,
          [&](const traces::Json& header, const std::string& name) { return replay_config(header, name, options); },
          options.threads, 1) {
  inputs_.warnings = ineffective_setting_warnings(options, inputs_.config);
  add_warnings(inputs_.warnings, technology_table_warnings(inputs_.config));
}

StoredFrames::StoredFrames(const std::filesystem::path& file, const RunConfig& config, std::uint32_t threads,
                           std::uint32_t replicates, const std::optional<TileSampling>& sampling)
    : StoredFrames(
          file,
          [&](const traces::Json& header, const std::string& name) {
            check_recorded(header, name, config);
            return config;
          },
          threads, replicates, sampling) {}

StoredFrames::StoredFrames(const std::filesystem::path& file,
                           const std::function<RunConfig(const traces::Json& header, const std::string& name)>& config,
                           std::uint32_t threads, std::uint32_t replicates, const std::optional<TileSampling>& sampling)
    : trace_(file), threads_(threads), replicates_(replicates), sampling_(sampling) {
  const std::string name = sim::printable(file.string());
  try {
    trace_.add_file_name_to_errors([&] { check_header(trace_.header()); });
    inputs_.config = config(trace_.header(), name);
  } catch (const sim::JsonError& error) {
    throw sim::InputError(fmt::format("{}: is damaged: {}", name, sim::printable(error.what())));
  }
  trace_.add_file_name_to_errors([&] {
    const traces::Json& header = trace_.header();
    program_ = kernels::parse_program(header.at("program").get<std::string>());
    const std::string reference = header.at("reference").get<std::string>();
    if (!reference.empty()) reference_ = kernels::parse_program(reference);
    const traces::Json& scene = header.at("scene");
    constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
    inputs_.scene.name = sim::printable(scene.at("name").get<std::string>());
    inputs_.scene.triangles = traces::number_at(scene, "triangles", kMost);
    inputs_.scene.instances = traces::number_at(scene, "instances", kMost);
    inputs_.scene.lights = traces::number_at(scene, "lights", kMost);
    inputs_.scene_sha256 = sim::printable(scene.at("sha256").get<std::string>());
    inputs_.bvh_hash = sim::printable(scene.at("bvh_hash").get<std::string>());
    kernels_ = kernels_of(header.at("kernels"));
    if (trace_.frames().empty()) throw sim::InputError("has no frames");
  });
  read_frame(0);
}

void StoredFrames::read_frame(std::size_t index) {
  index_ = index;
  trace_.add_file_name_to_errors([&] {
    const traces::Json& frame = trace_.frames()[index];
    const auto error_at = [&](const char* key) {
      const auto error = frame.at(key).get<double>();
      if (!(error >= 0 && error <= kLargestSquaredError)) throw sim::InputError(fmt::format("{} is out of range", key));
      return error;
    };
    error_ = {error_at("squared_error"), {}};
    if (frame.contains("squared_change_error")) error_.change = error_at("squared_change_error");
    if (frame.contains("flip")) error_.perceived.flip = error_at("flip"), error_.perceived.frames = 1;
    if (frame.contains("flicker")) error_.perceived.flicker = error_at("flicker"), error_.perceived.changes = 1;
    inputs_.frame = static_cast<std::uint32_t>(traces::number_at(frame, "frame", traces::kMaxFrame));
  });
}

bool StoredFrames::advance_frame() {
  if (index_ + 1 == trace_.frames().size()) return false;
  read_frame(index_ + 1);
  return true;
}

const Part& StoredFrames::find_part(bool reference, bool pilot) const {
  return trace_.add_file_name_to_errors([&]() -> const Part& {
    const auto found = std::ranges::find_if(trace_.parts(), [&](const Part& p) {
      return p.frame == inputs_.frame && p.reference == reference && p.pilot == pilot && p.tiles != 0;
    });
    if (found == trace_.parts().end()) throw sim::InputError(fmt::format("has no work of frame {}", inputs_.frame));
    return *found;
  });
}

void StoredFrames::load_tree(const Part& part) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  if (tree_ != part.tree) {
    scope_ = trace_.tile_scope(part, static_cast<std::uint32_t>(kernels_.size()));
    scope_.look_ups = inputs_.config.gpu->tni.predictor.enabled;
    trace_.add_file_name_to_errors([&] { fill_recorded_bvh(scope_, inputs_.config.bvh, inputs_.image); });
    inputs_.stored_triangles = scope_.counts.triangles;
    inputs_.parents = traces::parent_indices(inputs_.image);
    tree_ = part.tree;
  }
  scope_.region_bytes = part.requirements.region_bytes;
  inputs_.load_seconds += sim::seconds_since(begin);
}

double StoredFrames::estimate_seconds() {
  const double steps = recorded_steps();
  const RunParallelism parallelism{threads_, replicates_};
  HostRate rate = kUsualRate;
  // Tiles can be simulated alone only if they are independent of each other, as in the program `full`.
  const bool has_free_tiles = program_.has_independent_tiles();
  if (has_free_tiles && may_take_minutes(steps, parallelism)) {
    const Part& first = find_part(false);
    load_tree(first);
    ReplayProgram frame(trace_, first, scope_, kernels_);
    try {
      rate = measure_rate(inputs_, frame, NoTracer());
    } catch (const sim::Deadlock&) {  // the replay itself reports the error
    }
  }
  return inputs_.load_seconds + host_seconds_of_frame(steps, rate, parallelism);
}

FrameResult StoredFrames::simulate_part(const Part& part, const kernels::ProgramSpec& program,
                                        const SimulateOptions& extras, Caches& caches) {
  load_tree(part);
  ReplayProgram frame(trace_, part, scope_, kernels_);
  SimulateOptions own = extras;
  own.caches = std::exchange(caches, nullptr);
  FrameResult s = tools::simulate_program(inputs_, program, frame, NoTracer(), threads_, own);
  caches = std::exchange(s.caches, nullptr);
  return s;
}

FrameResult StoredFrames::simulate_samples() {
  const Part &part = find_part(false), &thin = find_part(false, true);
  load_tree(part);
  traces::TileScope thin_scope = scope_;
  thin_scope.region_bytes = thin.requirements.region_bytes;
  thin_scope.tile_bytes = traces::most_tile_bytes(thin.requirements);
  ReplayProgram pilot(trace_, thin, thin_scope, kernels_);
  const auto thinning = trace_.add_file_name_to_errors([&] { return thin.result.at("thinning").get<double>(); });
  const auto make_frame = [&]() -> std::unique_ptr<kernels::FrameProgram> {
    return std::make_unique<ReplayProgram>(trace_, part, scope_, kernels_);
  };
  const NoTracer tracer;
  return simulate_sampled(inputs_, program_, {make_frame, pilot, thinning, tracer}, threads_, *sampling_);
}

FrameResult StoredFrames::simulate(const SimulateOptions& extras) {
  if (sampling_) return simulate_samples();
  return simulate_part(find_part(false), program_, extras, caches_);
}

FrameResult StoredFrames::simulate_reference(const SimulateOptions& extras) {
  return simulate_part(find_part(true), *reference_, extras, reference_caches_);
}

PictureError StoredFrames::compare_pictures(const FrameResult&, const FrameResult&) { return error_; }

}  // namespace tools
