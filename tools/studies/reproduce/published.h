#pragma once
#include <map>
#include <string>

namespace tools::reproduce {

/// A published figure: one number, or what it lies between.
struct Range {
  double low = 0, high = 0;
  friend bool operator==(const Range&, const Range&) = default;
};

/// Identification of a figure: "table 1", "teapot", "super", "psnr_db".
struct FigureKey {
  std::string experiment, scene, setting, metric;
  friend auto operator<=>(const FigureKey&, const FigureKey&) = default;
};

using Published = std::map<FigureKey, Range>;

/// The published figures of a paper: tests/validation/published/PAPER.yaml, or published/PAPER.yaml below one of
/// search_folders(). InputError, with line and column, if it is no such file.
Published load_published(const std::string& paper);

/// The same from a text: experiment: scene: setting: {metric: number, metric: {low: number, high: number}}.
Published parse_published(const std::string& text, const std::string& name);

}  // namespace tools::reproduce
