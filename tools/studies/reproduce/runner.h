#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/studies/reproduce/bounces.h"
#include "tools/studies/reproduce/plan.h"

namespace tools::reproduce {

/// Classes of pixels, by how a pixel's sixteen samples on a regular grid differ. The first class that applies counts.
enum class Mask : std::uint8_t {
  kObjectEdge,  ///< visible objects differ, or a normal differs from that of the first sample (dot product below 0.9)
  kShadowEdge,  ///< a light reaches only some samples
  kReflectionEdge,  ///< objects or shadows seen in a mirror or through glass differ
  kTextureEdge,     ///< the surface is textured, and colours (sRGB-encoded) differ by more than 0.1 in a channel
  kElsewhere,
  kCount
};
constexpr std::array<std::string_view, static_cast<std::size_t>(Mask::kCount)> names_of(Mask) {
  return {"object_edges", "shadow_edges", "reflection_edges", "texture_edges", "elsewhere"};
}

/// Returns the class of each pixel of a scene's view, row by row.
std::vector<Mask> classify_pixels(const Inputs& inputs, std::uint32_t threads);

/// Mean squared error over the pixels of each class; empty for a class without pixels.
using MaskedErrors = std::array<std::optional<double>, static_cast<std::size_t>(Mask::kCount)>;
MaskedErrors masked_errors(std::span<const Mask> masks, std::span<const float> a, std::span<const float> b);

/// The result of running a frame program on a view of a scene.
struct ProgramResult {
  FrameResult simulation;
  std::uint64_t pixels = 0;
  std::uint64_t box_bytes = 0, node_bytes = 0;  ///< size of the BVH in memory: of its boxes alone, and of its nodes
  double bytes_per_triangle = 0;                ///< size of the BVH with its triangles
  double area_mm2 = 0;                          ///< nominal area of the machine; 0 without timing or area table
  std::uint64_t bounce_rays = 0;                ///< rays of the bounce (Case::bounce)
  double lines_per_1000_rays = 0;               ///< distinct lines of nodes that 1,000 of them read
  bool machine = true;                          ///< false: no timing was simulated, only the frame program was run
  const kernels::Sampling& sampling_counts() const { return simulation.rendered.sampling; }
};

/// The inputs from which a metric is computed: a run, its reference run, and the errors between their pictures.
struct Comparison {
  const ProgramResult& run;
  const ProgramResult& reference;
  double squared_error = 0;                  ///< mean squared error of the picture
  MaskedErrors masked{};                     ///< mean squared error by class of pixels, if a metric needs it
  std::optional<double> reflective_share{};  ///< share of the view's pixels whose surface reflects
};

/// A metric that compares a run with its reference run.
struct Metric {
  enum class Shown : std::uint8_t { kDecibel, kFactor, kShare, kCount, kMilliseconds };
  std::string_view name;
  std::string_view meaning;
  Shown shown;
  bool machine;  ///< true: the metric needs cycles or energy of the machine
  /// Computes the metric. Returns nothing if the metric is not defined, such as the PSNR of a picture that is identical
  /// to its reference.
  std::optional<double> (*measure)(const Comparison&);
};

/// Returns the metric with this name. Throws std::logic_error if there is none.
const Metric& find_metric(std::string_view name);

/// True if the metric needs errors by class of pixels (Comparison::masked).
bool needs_masks(std::string_view name);

/// Formats a value with its unit: "42.13 dB", "1.83 x", "5.2 %", "200", "1.207 ms".
std::string metric_text(const Metric& metric, double value);

/// Command-line options of `raywatt reproduce`.
struct Options {
  std::string paper;
  std::string config = "sgrt-2016";
  std::filesystem::path scenes;  ///< folder of scene files; may be empty
  std::filesystem::path out;     ///< empty: a dated folder in raywatt-out/
  bool quick = false;
  std::uint32_t shrink = 1;  ///< divisor of the width and height of pictures
  bool force = false;
  std::string progress = "auto";  ///< how progress is shown (Progress)
  std::uint32_t threads = 0;      ///< 0: all cores
  std::vector<std::string> argv;
};

/// A measured value, or the reason that there is none.
struct Measured {
  std::optional<double> value{};
  std::string why_not{};
};

/// Measures the metrics of a paper's experiments. Consecutive experiments share equal scenes, BVHs and runs.
class Runner {
 public:
  explicit Runner(const Options& options, Progress* progress = nullptr) : options_(options), progress_(progress) {}

  /// Runs an experiment and returns the values of its metrics, in the order of Case::metrics. Throws InputError if its
  /// scene does not exist or cannot be read.
  std::vector<Measured> measure_case(const Case& c);

  /// Returns the name or file of the scene that replaces the paper's scene. Throws InputError if there is none.
  std::string find_stand_in_scene(const View& view) const;

  /// Writes the pictures of the last measured experiment: of the run, of its reference, and four times their
  /// difference. Also writes the run's debug pictures (picture.h) and crops.
  void write_pictures(const Case& c, const std::filesystem::path& folder) const;

 private:
  void set_view(const Case& c);
  /// Loads the scene of an experiment and builds its BVH with the settings of the program.
  void load_scene(const Case& c, const ProgramSetup& program);
  JobOptions job_options(const Case& c, const ProgramSetup& program) const;
  const ProgramResult& result_of(const Case& c, const ProgramSetup& program);
  /// Plays the rays of one bounce alone.
  void play_bounce(const Case& c, const ProgramSetup& program, ProgramResult& out);
  const std::vector<float>& truth_picture(const Case& c);
  const std::vector<Mask>& pixel_masks(const Case& c);

  const Options& options_;
  Progress* progress_;
  std::optional<Inputs> inputs_;
  View view_;
  std::string inputs_key_;  ///< identifies the loaded scene and BVH (inputs_text())
  std::uint32_t width_ = 0, height_ = 0;
  std::optional<double> reflective_share_;
  /// Results for the current view and resolution, by program and settings.
  std::map<std::string, ProgramResult> results_by_program_;
  std::vector<BounceRays> bounces_;  ///< rays of the current view by bounce, of the program `bounces_program_`
  std::string bounces_program_;
  std::vector<float> truth_;
  std::vector<Mask> masks_;
};

/// Returns the share of the view's pixels whose surface sends a reflection ray, measured on a small picture.
double reflective_share(Inputs& inputs, std::uint32_t threads);

/// Changes materials to mirrors or to diffuse until about `share` (0 to 1) of the view's pixels reflect. Glass is
/// unchanged. The material that covers most pixels is changed first; one that would exceed `share` is skipped.
void set_reflective_share(Inputs& inputs, double share, std::uint32_t threads);

}  // namespace tools::reproduce
