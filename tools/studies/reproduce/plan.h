#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tools::reproduce {

/// Configuration settings "KEY=VALUE", as arguments of the option --set.
using Sets = std::vector<std::string>;

/// A scene and camera of a paper, and the scene that replaces them here.
struct View {
  std::string scene;               ///< name in the paper
  std::string stand_in;            ///< workload or built-in scene, used if no file of `files` exists; may be empty
  std::vector<std::string> files;  ///< candidate file names in --scenes DIR; the first that exists is used
  std::string camera{}, frame{};   ///< empty: those of the workload
  Sets sets{};
  std::uint32_t mirrors = 0;  ///< percentage of pixels to make reflective (set_reflective_share()); 0: unchanged
  friend bool operator==(const View&, const View&) = default;
};

/// The frame program of an experiment, and its configuration settings.
struct ProgramSetup {
  std::string name{};
  Sets sets{};
  /// Returns the program and its settings as options: "multirate:under --set multirate.attributes=dram".
  std::string program_text() const;
};

/// A metric to measure (find_metric()), and the paper's table or figure that has its published value.
struct PaperMetric {
  std::string experiment, metric;
};

/// A square detail of a picture, written enlarged eight times. `x` and `y`: centre, as shares of the picture's width
/// and height. `side`: as a share of the height.
struct Crop {
  std::string name;
  double x = 0, y = 0, side = 0;
};

/// Rays of a frame that T&I units traverse alone: those of one bounce of its paths, or their shadow rays.
struct Bounce {
  std::uint32_t number = 0;
  bool shadows = false;
};

/// One experiment of a paper: a scene and a setting, with a run, a reference run, and the metrics to measure.
struct Case {
  View view;
  std::string setting;
  std::uint32_t width = 0, height = 0;
  ProgramSetup run{};
  ProgramSetup reference{};
  bool machine = true;  ///< false: only the picture and sample counts are computed; no machine is simulated
  bool truth = false;   ///< true: PSNR compares with a picture of 256 samples per pixel, not with the reference
  std::optional<Bounce> bounce{};  ///< only these rays are traversed, by T&I units without shader cores
  std::vector<PaperMetric> metrics{};
  std::string
      picture{};  ///< name of the output files figure-PICTURE.png and figure-PICTURE-difference.png; empty: none
  std::vector<Crop> crops{};  ///< details to write as figure-PICTURE-NAME.png, also of the reference and difference
};

/// A paper and its experiments (`cases`). `quick` selects some of them, with lower resolution and fewer triangles.
struct Paper {
  std::string_view name;
  std::string_view title;
  std::string_view note;  ///< advice on how to compare measured with published values; may be empty
  std::vector<Case> (*cases)(bool quick);
};
std::vector<Case> lee_cases(bool quick);
std::vector<Case> kim_cases(bool quick);
std::vector<Case> jin_cases(bool quick);
std::vector<Case> chiu_cases(bool quick);
std::vector<Case> sgrt_unit_cases(bool quick);
std::vector<Case> hybrid_cases(bool quick);
std::vector<Case> wide_cases(bool quick);
std::vector<Case> coherence_cases(bool quick);
std::vector<Case> build_cases(bool quick);

/// Returns all papers whose experiments can be reproduced.
const std::vector<Paper>& all_papers();

/// Returns the settings of lights and rendering that all experiments use. traces/workloads/reproduction.yaml has the
/// same settings for built-in scenes.
Sets reproduction_settings();

/// Returns settings to measure T&I units alone: ideal shader cores and tile buffers, so that they never wait for rays.
Sets tni_alone_settings();

/// Returns the settings of `a`, then those of `b`, which override them.
Sets join_sets(Sets a, const Sets& b);

/// Returns metrics that are all shown in the same table or figure of a paper.
std::vector<PaperMetric> metric_list(const std::string& experiment, const std::vector<std::string>& metrics);

/// Returns an experiment with one sample per pixel at 512x256 pixels; a quarter of width and height if `quick`.
Case case_of_full_1(const View& view, const std::string& setting, const Sets& run, const Sets& reference, bool quick);

/// Returns the five scenes on which mechanisms of T&I units are compared; one small scene if `quick`.
std::vector<View> sgrt_views(bool quick);

/// Returns the width or height of an experiment's picture: `pixels`, or a sixteenth of it if `quick`.
std::uint32_t side_pixels(std::uint32_t pixels, bool quick);

}  // namespace tools::reproduce
