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
  std::filesystem::path scenes;  ///< folder of scene files; empty: none
  std::filesystem::path out;     ///< empty: a dated folder below raywatt-out/
  bool quick = false;
  std::uint32_t shrink = 1;  ///< sides of pictures are divided by this
  bool force = false;
  std::string progress = "auto";  ///< form of Progress
  std::uint32_t threads = 0;      ///< 0: all cores
  std::vector<std::string> argv;
};

/// A figure, or why there is none.
struct Measured {
  std::optional<double> value{};
  std::string why_not{};
};

/// Measures cases one after the other. What several of them need, scene, tree, runs, is made once as long as they
/// follow each other.
class Runner {
 public:
  explicit Runner(const Options& options, Progress* progress = nullptr) : options_(options), progress_(progress) {}

  /// The figures of a case in its order. InputError if its scene is not there or cannot be read.
  std::vector<Measured> measure(const Case& c);

  /// The scene that stands in, as a user would name it. InputError if it is not there.
  std::string stand_in(const View& view) const;

  /// Writes the pictures of the case last measured into a folder: the run's and those of how it came about
  /// (debug_pictures.h), what it is compared with (one file for all that are compared with it), four times their
  /// difference, and crops of these.
  void write_pictures(const Case& c, const std::filesystem::path& folder) const;

 private:
  void look_at(const Case& c);
  /// Scene and tree, as the program's keys want it.
  void load(const Case& c, const Program& program);
  JobOptions job(const Case& c, const Program& program) const;
  const Outcome& outcome(const Case& c, const Program& program);
  const std::vector<float>& truth(const Case& c);
  /// Those of this view and resolution.
  const std::vector<Mask>& masks(const Case& c);

  const Options& options_;
  Progress* progress_;
  std::optional<Inputs> inputs_;
  View view_;
  std::string inputs_key_;  ///< keys of what is loaded
  std::uint32_t width_ = 0, height_ = 0;
  std::optional<double> reflective_share_;
  std::map<std::string, Outcome> outcomes_;  ///< outcomes for this view and resolution
  std::vector<float> truth_;
  std::vector<Mask> masks_;
};

}  // namespace tools::reproduce
