#include <optional>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/host/process.h"
#include "tools/host/run_folder.h"
#include "tools/run/frame/host_time.h"
#include "tools/run/frame/run_job.h"
#include "tools/run/jobs.h"
#include "tools/run/run.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"
#include "traces/scene/images.h"

namespace tools {
namespace {

sim::Json counts_json(const traces::VerifyCounts& counts) {
  return {{"rays", counts.rays},
          {"missing_hits", counts.missing_hits},
          {"extra_hits", counts.extra_hits},
          {"distance_errors", counts.distance_errors},
          {"edge_ties", counts.edge_ties},
          {"reference_errors", counts.reference_errors}};
}

std::string counts_text(const traces::VerifyCounts& counts) {
  return fmt::format("{} rays against Embree {}: {} missing hits, {} extra hits, {} distance errors, {} edge ties",
                     counts.rays, traces::embree_version(), counts.missing_hits, counts.extra_hits,
                     counts.distance_errors, counts.edge_ties);
}

/// Returns the comparison with Embree as JSON. `squared_error`: mean over all channels of the pictures.
sim::Json comparison_json(const traces::VerifyCounts& counts, double squared_error) {
  const std::optional<double> psnr = psnr_db(squared_error);
  sim::Json json = counts_json(counts);
  json["psnr_db"] = psnr ? sim::Json(*psnr) : sim::Json(nullptr);
  json["identical"] = !psnr.has_value();
  return json;
}

/// Compares frames with Embree one after the other and sums the results.
class Verification {
 public:
  const traces::VerifyCounts& counts() const { return counts_; }
  const sim::Json& frames() const { return frames_; }
  double mean_squared_error() const { return squared_error_ / static_cast<double>(frames_.size()); }

  /// Compares all frames with Embree, or those finished before an interrupt. Throws Interrupted if no frame is
  /// finished. Writes the first frame's picture, and its picture traced by Embree.
  void verify_all(Inputs& inputs, const JobOptions& options, Progress& progress, const RunFolder::Open& open) {
    try {
      do {
        verify_frame(inputs, options, progress, open);
      } while (advance_frame(inputs, options.threads, &progress));
    } catch (const Interrupted&) {
      if (frames_.empty()) throw;
    }
  }

 private:
  void verify_frame(const Inputs& inputs, const JobOptions& options, Progress& progress, const RunFolder::Open& open) {
    const kernels::ProgramSpec program = kernels::parse_program(options.program);
    const traces::BvhTracer tested(inputs.image, inputs.config.gpu->tni.predictor);
    progress.set_phase("building Embree's tree");
    const traces::EmbreeTracer embree(inputs.image, host_threads(options.threads), is_interrupted);
    const traces::VerifyingTracer verifying(inputs.image, tested, embree);
    const SimulateOptions extras{.progress = &progress};
    const std::vector<float> ours = render_frame(inputs, program, verifying, options.threads, extras).rgb;
    const std::vector<float> truth = render_frame(inputs, program, embree, options.threads, extras).rgb;
    if (frames_.empty()) {
      const std::uint32_t width = inputs.config.render.width, height = inputs.config.render.height;
      traces::write_png(open() / "image.png", width, height, to_rgb8(ours));
      traces::write_png(open() / "embree.png", width, height, to_rgb8(truth));
    }
    const double squared_error = tools::mean_squared_error(ours, truth);
    sim::Json entry = {{"frame", inputs.frame}};
    entry.update(comparison_json(verifying.verify_counts(), squared_error));
    frames_.push_back(std::move(entry));
    counts_ += verifying.verify_counts();
    squared_error_ += squared_error;
  }

  traces::VerifyCounts counts_;
  double squared_error_ = 0;  ///< mean squared error, summed over frames
  sim::Json frames_ = sim::Json::array();
};

/// Estimates the host seconds to load the scene and verify all frames.
double estimated_verify_seconds(const Inputs& inputs, const JobOptions& options) {
  constexpr double kTimes = 2;  // chosen; rays are traced once by this program and twice by Embree
  const kernels::ProgramSpec spec = kernels::parse_program(options.program);
  return inputs.load_seconds + estimate_render_seconds(inputs, spec, kTimes, options.threads) * inputs.frames();
}

}  // namespace

int verify_frames(const JobOptions& options) {
  kernels::parse_program(options.program);
  RunFolder folder(options.out, options.force, {.mark = "verify.json"});
  Progress progress(options.progress, options.quiet);
  Inputs inputs = load_inputs(options, &progress);
  print_warnings(inputs.warnings, &progress);
  if (progress.shows_hints())
    print_duration_hint(estimated_verify_seconds(inputs, options), "a smaller --resolution or fewer --frames take less",
                        progress);
  progress.expect_parts(2 * inputs.frames());
  const std::size_t to_replace = min_frames_to_replace(folder.target() / "verify.json");
  Verification done;
  folder.fill([&](const RunFolder::Open& open) {
    done.verify_all(inputs, options, progress, open);
    const bool partial = done.frames().size() < inputs.frames();
    progress.finish(partial ? "interrupted" : "done");
    if (partial && done.frames().size() < to_replace) throw Interrupted();
    sim::Json json = {{"schema", "raywatt-verify/1"}, {"partial", partial}};
    json.update(comparison_json(done.counts(), done.mean_squared_error()));
    json["frames"] = done.frames();
    json["provenance"] = provenance_json(inputs, options);
    sim::write_file_atomically(open() / "verify.json", sim::json_lines(json));
    return fmt::format("{} of {} frames", done.frames().size(), inputs.frames());
  });
  const traces::VerifyCounts& counts = done.counts();
  if (!options.quiet) {
    const std::optional<double> psnr = psnr_db(done.mean_squared_error());
    fmt::print("{}, picture {}\n", counts_text(counts), psnr ? fmt::format("{:.2f} dB", *psnr) : "identical");
    fmt::print("details: {}\n", (folder.target() / "verify.json").string());
  }
  return counts.error_count() == 0 ? kGood : kCheckFailed;
}

int verify_rays(const JobOptions& options) {
  RunFolder folder(options.out, options.force, {.mark = "verify.json"});
  Progress progress(options.progress, options.quiet);
  const RayList list = read_ray_list(options.rays);
  const Inputs inputs = load_inputs(options, &progress);
  print_warnings(inputs.warnings, &progress);
  const traces::BvhTracer tested(inputs.image);
  progress.set_phase("building Embree's tree");
  const traces::EmbreeTracer embree(inputs.image, host_threads(options.threads));
  const traces::VerifyingTracer verifying(inputs.image, tested, embree);
  std::vector<traces::Hit> hits(list.rays.size());
  progress.begin_part("tracing", 0, 1);
  verifying.trace(list.rays, options.any_hit ? traces::RayKind::kShadow : traces::RayKind::kPrimary, hits, nullptr);
  const traces::VerifyCounts counts = verifying.verify_counts();
  progress.set_tiles_done(1, counts.rays, 0);
  progress.finish("done");
  folder.fill([&](const RunFolder::Open& open) {
    sim::Json json = {{"schema", "raywatt-verify/1"}, {"partial", false}};
    json.update(counts_json(counts));
    json["provenance"] = provenance_json(inputs, options);
    json["provenance"]["rays_sha256"] = list.sha256;
    sim::write_file_atomically(open() / "verify.json", sim::json_lines(json));
    return std::string("all rays");
  });
  if (!options.quiet) {
    fmt::print("{}\ndetails: {}\n", counts_text(counts), (folder.target() / "verify.json").string());
  }
  return counts.error_count() == 0 ? kGood : kCheckFailed;
}

}  // namespace tools
