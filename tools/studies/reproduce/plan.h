#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tools::reproduce {

/// Arguments as of --set.
using Sets = std::vector<std::string>;

/// A scene of a paper and what stands in for it.
struct View {
  std::string scene;               ///< as the paper calls it
  std::string stand_in;            ///< workload or built-in scene, if none of `files` is there; may be empty
  std::vector<std::string> files;  ///< names to look for in --scenes DIR, first come first
  std::string camera{}, frame{};   ///< empty: the workload's
  Sets sets{};
  std::uint32_t mirrors = 0;  ///< per cent of pixels that shall reflect (mirrors.h); 0: as the scene is
  friend bool operator==(const View&, const View&) = default;
};

/// A frame program and its keys.
struct Program {
  std::string name{};
  Sets sets{};
  /// "multirate:under --set multirate.attributes=dram"
  std::string text() const;
};

/// A figure to measure: where it stands in the paper, and what it is (metrics.h).
struct Figure {
  std::string experiment, metric;
};

/// A square of a picture, enlarged eight times: its centre, in shares of width and height, and its side, of the height.
struct Crop {
  std::string name;
  double x = 0, y = 0, side = 0;
};

/// One setting on one scene: what is run, what it is compared with, and the figures that come of it.
struct Case {
  View view;
  std::string setting;
  std::uint32_t width = 0, height = 0;
  Program run{};
  Program reference{};
  bool machine = true;  ///< false: the picture and the counts of samples alone
  bool truth = false;   ///< PSNR against 256 samples per pixel instead of the reference
  std::vector<Figure> figures{};
  std::string picture{};      ///< figure-PICTURE.png and figure-PICTURE-difference.png; empty: none
  std::vector<Crop> crops{};  ///< figure-PICTURE-NAME.png, of the reference and the difference, too
};

/// The experiments of a paper. `quick`: at a fraction of the resolution, some of them, and the built-in scenes made of
/// few triangles.
struct Paper {
  std::string_view name;
  std::string_view title;
  std::string_view note;  ///< how its figures and ours go together; may be empty
  std::vector<Case> (*cases)(bool quick);
};
std::vector<Case> lee2016(bool quick);
std::vector<Case> kim2016(bool quick);
std::vector<Case> jin2009(bool quick);
std::vector<Case> chiu(bool quick);
std::vector<Case> sgrt_units(bool quick);
std::vector<Case> hybrid(bool quick);

/// All of them.
const std::vector<Paper>& papers();

/// Keys that make any scene one of these experiments', as traces/workloads/reproduction.yaml does for the built-in
/// ones.
Sets reproduction_rules();

/// Keys of a machine whose T&I units always have rays at hand, as where they are measured by themselves.
Sets tni_alone();

/// Pixels of one side when a plan is quick.
std::uint32_t side(std::uint32_t pixels, bool quick);

}  // namespace tools::reproduce
