#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tools::reproduce {

/// Configuration settings, as arguments of the option --set.
using Sets = std::vector<std::string>;

/// A scene and camera of a paper, and the scene that replaces it here.
struct View {
  std::string scene;               ///< name in the paper
  std::string stand_in;            ///< workload or built-in scene, used if no file of `files` exists; may be empty
  std::vector<std::string> files;  ///< candidate file names in --scenes DIR; the first that exists is used
  std::string camera{}, frame{};   ///< empty: those of the workload
  Sets sets{};
  std::uint32_t mirrors = 0;  ///< percentage of pixels to make reflective (set_reflective_share()); 0: unchanged
  friend bool operator==(const View&, const View&) = default;
};

/// A frame program of an experiment, and its configuration settings.
struct ProgramSetup {
  std::string name{};
  Sets sets{};
  /// Returns the program and its settings as options: "multirate:under --set multirate.attributes=dram".
  std::string program_text() const;
};

/// A metric to measure (runner.h), and the paper's table or figure that shows it.
struct PaperMetric {
  std::string experiment, metric;
};

/// A square detail of a picture, shown enlarged eight times. Centre in shares of width and height; side as a share of
/// the height.
struct Crop {
  std::string name;
  double x = 0, y = 0, side = 0;
};

/// One experiment: a setting on one scene, with its run, its reference run, and the metrics to measure.
struct Case {
  View view;
  std::string setting;
  std::uint32_t width = 0, height = 0;
  ProgramSetup run{};
  ProgramSetup reference{};
  bool machine = true;  ///< false: only the picture and sample counts are computed, without timing
  bool truth = false;   ///< true: PSNR is relative to 256 samples per pixel, not to the reference
  std::vector<PaperMetric> metrics{};
  std::string
      picture{};  ///< name of the output files figure-PICTURE.png and figure-PICTURE-difference.png; empty: none
  std::vector<Crop> crops{};  ///< details to write as figure-PICTURE-NAME.png, also of the reference and the difference
};

/// The experiments of a paper. `quick` selects some of them and reduces their resolution and numbers of triangles.
struct Paper {
  std::string_view name;
  std::string_view title;
  std::string_view note;  ///< advice on comparing published with measured values; may be empty
  std::vector<Case> (*cases)(bool quick);
};
std::vector<Case> lee_cases(bool quick);
std::vector<Case> kim_cases(bool quick);
std::vector<Case> jin_cases(bool quick);
std::vector<Case> chiu_cases(bool quick);
std::vector<Case> sgrt_unit_cases(bool quick);
std::vector<Case> hybrid_cases(bool quick);

/// Returns all papers whose experiments can be reproduced.
const std::vector<Paper>& all_papers();

/// Returns settings of lights and rendering that all experiments use. traces/workloads/reproduction.yaml has the same
/// settings for built-in scenes.
Sets reproduction_settings();

/// Returns settings with ideal shader cores and tile buffers. T&I units then never wait for rays.
Sets tni_alone_settings();

/// Returns the side of a picture in pixels: `pixels`, or one sixteenth of it if `quick`.
std::uint32_t side_pixels(std::uint32_t pixels, bool quick);

}  // namespace tools::reproduce
