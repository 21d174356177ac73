#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "tools/run/frame/run_job.h"
#include "tools/studies/reproduce/masks.h"

namespace tools::reproduce {

/// One program on one view.
struct Outcome {
  FrameResult simulation;
  std::uint64_t pixels = 0;
  std::uint64_t box_bytes = 0, node_bytes = 0;  ///< the tree in the GPU's memory: boxes alone, and whole nodes
  bool machine = true;                          ///< else `simulation` has nothing but what the frame program found out
  const kernels::Sampling& sampling() const { return simulation.rendered.sampling; }
};

/// Runs that a figure is made from.
struct Comparison {
  const Outcome& run;
  const Outcome& reference;
  double squared_error = 0;                  ///< error of the run's picture
  MaskedErrors masked{};                     ///< the same by mask, if a figure asks for it
  std::optional<double> reflective_share{};  ///< share of the view's pixels
};

/// A figure that can be measured.
struct Metric {
  enum class Shown : std::uint8_t { kDecibel, kFactor, kShare, kCount, kMilliseconds };
  std::string_view name;
  std::string_view meaning;
  Shown shown;
  bool machine;  ///< needs cycles or energy
  /// Nothing if the run has no such figure: a picture identical to its reference has no PSNR.
  std::optional<double> (*measure)(const Comparison&);
};

std::span<const Metric> metrics();
/// Throws std::logic_error for a name that is none of them.
const Metric& find_metric(std::string_view name);

/// Whether a metric needs errors by mask.
bool asks_for_masks(std::string_view name);

/// "42.13 dB", "1.83 x", "5.2 %", "200", "1.207 ms"
std::string metric_text(const Metric& metric, double value);

}  // namespace tools::reproduce
