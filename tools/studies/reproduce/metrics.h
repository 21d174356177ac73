#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tools/run/frame/run_job.h"
#include "tools/studies/reproduce/masks.h"

namespace tools::reproduce {

/// The result of a program on a view.
struct ProgramResult {
  FrameResult simulation;
  std::uint64_t pixels = 0;
  std::uint64_t box_bytes = 0, node_bytes = 0;  ///< size of the tree in memory: only boxes; whole nodes
  bool machine = true;                          ///< false: `simulation` has only results of the frame program
  const kernels::Sampling& sampling_counts() const { return simulation.rendered.sampling; }
};

/// The runs that a metric is computed from.
struct Comparison {
  const ProgramResult& run;
  const ProgramResult& reference;
  double squared_error = 0;                  ///< of the picture
  MaskedErrors masked{};                     ///< by mask, if a metric needs it
  std::optional<double> reflective_share{};  ///< of the pixels of the view
};

/// A metric that can be measured.
struct Metric {
  enum class Shown : std::uint8_t { kDecibel, kFactor, kShare, kCount, kMilliseconds };
  std::string_view name;
  std::string_view meaning;
  Shown shown;
  bool machine;  ///< needs cycles or energy
  /// Returns nothing if the metric does not exist: the PSNR of a picture that is identical to its reference.
  std::optional<double> (*measure)(const Comparison&);
};

/// Returns the metric of a name; std::logic_error if there is none.
const Metric& find_metric(std::string_view name);

/// True if the metric needs errors by mask.
bool needs_masks(std::string_view name);

/// "42.13 dB", "1.83 x", "5.2 %", "200", "1.207 ms"
std::string metric_text(const Metric& metric, double value);

}  // namespace tools::reproduce
