#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/reproduce/metrics.h"
#include "tools/studies/reproduce/plan.h"

namespace tools::reproduce {

/// Options of `raywatt reproduce`.
struct Options {
  std::string paper;
  std::string config = "sgrt-2016";
  std::filesystem::path scenes;  ///< folder of scene files; may be empty
  std::filesystem::path out;     ///< empty: a dated folder in raywatt-out/
  bool quick = false;
  std::uint32_t shrink = 1;  ///< sides of pictures are divided by this
  bool force = false;
  std::string progress = "auto";  ///< form of Progress
  std::uint32_t threads = 0;      ///< 0: all cores
  std::vector<std::string> argv;
};

/// A value, or the reason that there is none.
struct Measured {
  std::optional<double> value{};
  std::string why_not{};
};

/// Measures cases. Scene, tree and runs are reused by consecutive cases that need the same.
class Runner {
 public:
  explicit Runner(const Options& options, Progress* progress = nullptr) : options_(options), progress_(progress) {}

  /// Returns the metrics of a case in its order. InputError if its scene does not exist or cannot be read.
  std::vector<Measured> measure_case(const Case& c);

  /// Returns the name or file of the scene that replaces the one of the paper. InputError if there is none.
  std::string stand_in(const View& view) const;

  /// Writes the pictures of the last measured case: of the run, its debug pictures (debug_pictures.h), its reference
  /// (one file per reference), four times the difference, and crops of these.
  void write_pictures(const Case& c, const std::filesystem::path& folder) const;

 private:
  void set_view(const Case& c);
  /// Loads the scene and builds the tree with the keys of the program.
  void load_scene(const Case& c, const ProgramSetup& program);
  JobOptions job_options(const Case& c, const ProgramSetup& program) const;
  const ProgramResult& result_of(const Case& c, const ProgramSetup& program);
  const std::vector<float>& truth_picture(const Case& c);
  const std::vector<Mask>& pixel_masks(const Case& c);

  const Options& options_;
  Progress* progress_;
  std::optional<Inputs> inputs_;
  View view_;
  std::string inputs_key_;  ///< of the loaded scene
  std::uint32_t width_ = 0, height_ = 0;
  std::optional<double> reflective_share_;
  std::map<std::string, ProgramResult> results_by_program_;  ///< for the current view and resolution
  std::vector<float> truth_;
  std::vector<Mask> masks_;
};

/// Returns the share of the view's pixels whose surface sends a reflection ray, measured on a small picture.
double reflective_share(Inputs& inputs, std::uint32_t threads);

/// Makes materials mirrors or diffuse until about `share` (0 to 1) of the view's pixels reflect. Glass is unchanged.
/// Materials are chosen by the number of pixels that they cover, largest first, as long as they fit.
void set_reflective_share(Inputs& inputs, double share, std::uint32_t threads);

}  // namespace tools::reproduce
