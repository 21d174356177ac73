#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tools::reproduce {

/// Arguments of --set.
using Sets = std::vector<std::string>;

/// A scene of a paper, and the scene that replaces it.
struct View {
  std::string scene;               ///< name in the paper
  std::string stand_in;            ///< workload or built-in scene, used if no file of `files` exists; may be empty
  std::vector<std::string> files;  ///< file names in --scenes DIR; the first that exists is used
  std::string camera{}, frame{};   ///< empty: camera and frame of the workload
  Sets sets{};
  std::uint32_t mirrors = 0;  ///< percent of pixels that reflect (set_reflective_share()); 0: unchanged
  friend bool operator==(const View&, const View&) = default;
};

/// A frame program and its keys.
struct ProgramSetup {
  std::string name{};
  Sets sets{};
  /// Returns the program and its settings as options: "multirate:under --set multirate.attributes=dram".
  std::string program_text() const;
};

/// A metric to measure (runner.h), and its table or figure in the paper.
struct PaperMetric {
  std::string experiment, metric;
};

/// A square of a picture, enlarged eight times. The centre is in shares of width and height, the side of the height.
struct Crop {
  std::string name;
  double x = 0, y = 0, side = 0;
};

/// One setting on one scene: the run, its reference, and the metrics to measure.
struct Case {
  View view;
  std::string setting;
  std::uint32_t width = 0, height = 0;
  ProgramSetup run{};
  ProgramSetup reference{};
  bool machine = true;  ///< false: no machine is simulated; only the picture and the counts of samples are made
  bool truth = false;   ///< PSNR against 256 samples per pixel, not against the reference
  std::vector<PaperMetric> metrics{};
  std::string picture{};      ///< figure-PICTURE.png and figure-PICTURE-difference.png; empty: none
  std::vector<Crop> crops{};  ///< figure-PICTURE-NAME.png, also of the reference and the difference
};

/// The experiments of a paper. `quick` selects some of them, at a fraction of the resolution and with fewer triangles.
struct Paper {
  std::string_view name;
  std::string_view title;
  std::string_view note;  ///< how to compare its figures with ours; may be empty
  std::vector<Case> (*cases)(bool quick);
};
std::vector<Case> lee_cases(bool quick);
std::vector<Case> kim_cases(bool quick);
std::vector<Case> jin_cases(bool quick);
std::vector<Case> chiu_cases(bool quick);
std::vector<Case> sgrt_unit_cases(bool quick);
std::vector<Case> hybrid_cases(bool quick);

/// All papers.
const std::vector<Paper>& all_papers();

/// Returns settings that adapt a scene to these experiments, as traces/workloads/reproduction.yaml does for built-in
/// scenes.
Sets reproduction_settings();

/// Returns settings of a machine whose T&I units never wait for rays, so that they are measured alone.
Sets tni_alone_settings();

/// Returns the side of a picture in pixels: `pixels`, or a fraction of it if `quick`.
std::uint32_t side_pixels(std::uint32_t pixels, bool quick);

}  // namespace tools::reproduce
